"""The starter of an exercise, with its sheet, as students get it."""

from __future__ import annotations

import importlib.util
import keyword
import re
import shlex
import sys
import unicodedata
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from grader.errors import UsageError
from grader.exercise.exercise import Exercise
from grader.exercise.places import is_installed
from grader.exercise.sheet import Start, sheet
from grader.scenes.subject import Subject
from grader.submission.folder import NO_SOURCES
from grader.submission.manifest import FILE as MANIFEST
from grader.submission.manifest import naming

#: The files of a starter that depend on the release.
ADAPTED = ("*.py", "package.xml", "README.md")
SHEET = "README.md"
#: The program where there is no starter.
PROGRAM = "my_node.py"


@dataclass(frozen=True)
class Starter:
    """A starter that was written.

    Attributes:
        package: the name of the package; '' where it is none.
        words: what names the exercise to `grader run`; none where the files do.
        to_fill_in: the Python files with a TODO.
    """

    package: str
    words: tuple[str, ...]
    to_fill_in: tuple[str, ...]


def write(folder: Path, exercise: Exercise, given: str, called: str, ros: str | None) -> Starter:
    """Write the starter of an exercise, and its sheet, into a new folder.

    Args:
        given: the name or path of the exercise.
        called: what students know the folder as.
        ros: the ROS 2 release that it is for; none: as it comes.
    """
    try:
        files = exercise.starter_files()
        package = _package_name(called, exercise.starter_package, files)
        files = exercise.starter_files(package)
    except OSError as error:
        why = error.strerror or str(error)
        raise UsageError(
            "cannot copy {source}: {why}; nothing was written", source=error.filename, why=why
        ) from None
    folder.mkdir(parents=True)
    if exercise.starter is None and exercise.is_started:
        files = {PROGRAM: b"# TODO: your node\n"}
    for name, data in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(data)
    is_named = _name_exercise(folder, exercise.name) and is_installed(given)
    words = () if is_named else ("--exercise", given)
    if not (folder / SHEET).exists():  # else its author has written one
        _write_sheet(folder, exercise, Path(called), package, grading(called, words))
    if ros:
        _adapt(folder, exercise.subject, ros)
    return Starter(package, words, tuple(_with_todos(folder)))


def grading(folder: str, words: Sequence[str]) -> str:
    """Return the command that grades a folder."""
    place = f"./{folder}" if folder.startswith("-") else folder
    return shlex.join(["grader", "run", place, *words])


def _package_name(called: str, before: str, given: Iterable[str]) -> str:
    """Return the name for the package of a starter in a folder; '' where it is none.

    Args:
        called: the folder's name.
        before: the name that the package has.
        given: the paths of its files.

    Two packages in a workspace may not share one, and it hides no module that is there already.
    """
    if not before:
        return ""
    plain = unicodedata.normalize("NFKD", called).encode("ascii", "ignore").decode().lower()
    name = re.sub("[^a-z0-9]+", "_", plain).strip("_")
    if not name:
        raise UsageError(
            "cannot name a package after the folder {folder}: give one whose name has letters from "
            "a to z; nothing was written",
            folder=called,
        )
    others = {Path(path).parts[0] for path in given} - {before}
    module = None if keyword.iskeyword(name) else importlib.util.find_spec(name)
    is_taken = (
        len(name) == 1  # colcon's linter asks for two letters
        or name[0].isdigit()
        or keyword.iskeyword(name)
        or name in sys.stdlib_module_names
        or name in NO_SOURCES
        or name in others
        or (module is not None and module.origin is not None)
    )
    return f"my_{name}" if is_taken else name


def _name_exercise(folder: Path, exercise: str) -> bool:
    """Have the files of a starter name their exercise; return whether there is one to do so."""
    files = list(folder.rglob(MANIFEST)) or list(folder.rglob("*.py"))
    for path in files:
        text = path.read_bytes().decode("utf-8", "surrogateescape")
        made = naming(text, exercise, is_manifest=path.name == MANIFEST)
        path.write_bytes(made.encode("utf-8", "surrogateescape"))
    return bool(files)


def _write_sheet(folder: Path, exercise: Exercise, called: Path, package: str, grade: str) -> None:
    to_fill_in = _with_todos(folder)  # what lies in a Python package first
    to_fill_in.sort(key=lambda file: not (folder / file).with_name("__init__.py").exists())
    program = next(iter(to_fill_in), PROGRAM)
    start = Start(str(called / program), package, grade)
    made = sheet(exercise, exercise.subject, start)
    (folder / SHEET).write_text(made, encoding="utf-8")


def _adapt(folder: Path, subject: Subject, ros_distro: str) -> None:
    """Change the files for a ROS 2 release, whose names may differ."""
    for path in (path for pattern in ADAPTED for path in folder.rglob(pattern)):
        text = path.read_bytes().decode("utf-8", "surrogateescape")
        path.write_bytes(subject.adapted(text, ros_distro).encode("utf-8", "surrogateescape"))


def _with_todos(folder: Path) -> list[str]:
    """Return the Python files that contain a TODO."""
    found = (path for path in sorted(folder.rglob("*.py")) if b"TODO" in path.read_bytes())
    return [str(path.relative_to(folder)) for path in found]
