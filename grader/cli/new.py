"""Write the exercise sheet and the starter package of the challenge, or of another exercise."""

from __future__ import annotations

import argparse
import importlib.util
import keyword
import os
import re
import shlex
import shutil
import sys
import unicodedata
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from grader import files
from grader.errors import UsageError
from grader.exercise import DEFAULT
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.exercise.places import is_installed
from grader.exercise.sheet import Start, sheet
from grader.recording.subject import Subject
from grader.submission.folder import NO_SOURCES
from grader.submission.manifest import FILE as MANIFEST
from grader.submission.manifest import naming
from grader.translations import tr

#: The ROS 2 releases that a starter can be for.
RELEASES = ("humble", "jazzy", "kilted", "lyrical", "rolling")
#: The files of a starter that depend on the release.
ADAPTED = ("*.py", "package.xml", "README.md")
SHEET = "README.md"
#: The program where there is no starter.
PROGRAM = "my_node.py"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument("folder", type=Path, metavar="DIR", help=tr("a new or empty folder"))
    parser.add_argument(
        "--exercise", default=DEFAULT, metavar="NAME|FOLDER", help=tr("which one (the challenge)")
    )
    parser.add_argument(
        "--ros",
        choices=RELEASES,
        default=os.environ.get("ROS_DISTRO"),
        help=tr("the ROS 2 release that it is for; default: the sourced one, else as it comes"),
    )


def main(args: argparse.Namespace) -> int:
    """Copy the starter and write the sheet, into a new or empty folder alone.

    Raises:
        UsageError: the folder is not empty, or cannot be written.
    """
    folder: Path = args.folder
    exercise = load_exercise(args.exercise)
    with files.writing(folder):
        if folder.exists() and not folder.is_dir():
            raise UsageError(
                "{folder} is a file; give a new folder, nothing was written", folder=folder
            )
        if folder.exists() and any(folder.iterdir()):
            raise UsageError(
                "{folder} is not empty; give a new folder, nothing was written", folder=folder
            )
        called = folder.resolve().name
        try:
            given = exercise.starter_files()
            package = _package_name(called, exercise.starter_package, given)
            given = exercise.starter_files(package)
        except OSError as error:
            why = error.strerror or str(error)
            raise UsageError(
                "cannot copy {source}: {why}; nothing was written", source=error.filename, why=why
            ) from None
        with _whole_or_not_at_all(folder) as copy:
            copy.mkdir()
            if exercise.starter is None and exercise.is_started:
                given = {PROGRAM: b"# TODO: your node\n"}
            for name, data in given.items():
                (copy / name).parent.mkdir(parents=True, exist_ok=True)
                (copy / name).write_bytes(data)
            is_named = _name_exercise(copy, exercise.name) and is_installed(args.exercise)
            words = [] if is_named else ["--exercise", args.exercise]
            if not (copy / SHEET).exists():  # else its author has written one
                _write_sheet(copy, exercise, Path(called), package, _grading(called, words))
            if args.ros:
                _adapt(copy, exercise.subject, args.ros)
    to_fill_in = _with_todos(folder)
    if exercise.starter is None:
        print(tr("The exercise sheet is in {folder}.", folder=folder))
    else:
        print(tr("The starter package is in {folder}.", folder=folder))
    if package not in ("", called):
        print(tr("The package is called {package}.", package=package))
    print(tr("{sheet} says what is asked for and how it is judged.", sheet=SHEET))
    if to_fill_in:
        print(tr("Fill in the TODOs of {to_fill_in}, then run:", to_fill_in=", ".join(to_fill_in)))
    else:
        print(tr("Then run:"))
    print(f"    {_grading(str(folder), words)}")
    return 0


def _grading(folder: str, words: Sequence[str]) -> str:
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

    Raises:
        UsageError: the folder's name has no letter or digit for it.
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


def _write_sheet(copy: Path, exercise: Exercise, called: Path, package: str, grade: str) -> None:
    to_fill_in = _with_todos(copy)  # what lies in a Python package first
    to_fill_in.sort(key=lambda file: not (copy / file).with_name("__init__.py").exists())
    program = next(iter(to_fill_in), PROGRAM)
    start = Start(str(called / program), package, grade)
    made = sheet(exercise, exercise.subject, start)
    (copy / SHEET).write_text(made, encoding="utf-8")


@contextmanager
def _whole_or_not_at_all(folder: Path) -> Iterator[Path]:
    """Yield a path for a copy, which is moved into the folder when it is whole, else removed."""
    is_new = not folder.exists()
    folder.mkdir(parents=True, exist_ok=True)
    unfinished = folder / f".unfinished.{os.getpid()}"
    try:
        yield unfinished
        for path in unfinished.iterdir():
            path.rename(folder / path.name)
    except BaseException:
        shutil.rmtree(folder if is_new else unfinished, ignore_errors=True)
        raise
    unfinished.rmdir()


def _adapt(folder: Path, subject: Subject, ros_distro: str) -> None:
    """Change the files for a ROS 2 release, whose names may differ."""
    for path in (path for pattern in ADAPTED for path in folder.rglob(pattern)):
        text = path.read_bytes().decode("utf-8", "surrogateescape")
        path.write_bytes(subject.adapted(text, ros_distro).encode("utf-8", "surrogateescape"))


def _with_todos(folder: Path) -> list[str]:
    """Return the Python files that contain a TODO."""
    found = (path for path in sorted(folder.rglob("*.py")) if b"TODO" in path.read_bytes())
    return [str(path.relative_to(folder)) for path in found]
