"""Write the exercise sheet and the starter package of the challenge, or of another exercise."""

from __future__ import annotations

import argparse
import os
import re
import shlex
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from grader import files
from grader.errors import UsageError
from grader.exercise import DEFAULT
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.exercise.sheet import Start, sheet
from grader.recording.subject import Subject
from grader.translations import tr

#: The ROS 2 releases that a starter can be for.
RELEASES = ("humble", "jazzy", "kilted", "lyrical", "rolling")
#: The files of a starter that depend on the release.
ADAPTED = ("*.py", "package.xml", "README.md")
SHEET = "README.md"
#: The name of the program on the sheet if there is no starter.
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
    try:
        if folder.exists() and not folder.is_dir():
            raise UsageError(
                "{folder} is a file; give a new folder, nothing was written", folder=folder
            )
        if folder.exists() and any(folder.iterdir()):
            raise UsageError(
                "{folder} is not empty; give a new folder, nothing was written", folder=folder
            )
        with _whole_or_not_at_all(folder) as copy:
            if exercise.starter is None:
                copy.mkdir()
            else:
                skip = shutil.ignore_patterns("__pycache__", "*.pyc")
                shutil.copytree(exercise.starter, copy, ignore=skip)
            if not (copy / SHEET).exists():  # else its author has written one
                _write_sheet(copy, exercise, _grading(folder.resolve().name, args.exercise))
            if args.ros:
                _adapt(copy, exercise.subject, args.ros)
    except shutil.Error as error:
        source, _, why = error.args[0][0]  # (source, target, why) of each file
        raise UsageError(
            "cannot copy {source}: {why}; nothing was written", source=source, why=why
        ) from None
    except OSError as error:
        raise files.cannot_write(folder, error.strerror or str(error)) from None
    has_starter = exercise.starter is not None
    if has_starter:
        print(tr("The starter package is in {folder}.", folder=folder))
    else:
        print(tr("The exercise sheet is in {folder}.", folder=folder))
    print(tr("{sheet} says what is asked for and how it is judged.", sheet=SHEET))
    to_fill_in = _with_todos(folder)
    if to_fill_in:
        print(tr("Fill in the TODOs of {to_fill_in}, then run:", to_fill_in=", ".join(to_fill_in)))
    else:
        then = tr("Write {program} beside it, then run:", program=PROGRAM)
        print(tr("Then run:") if has_starter else then)
    print(f"    {_grading(str(folder), args.exercise)}")
    return 0


def _grading(folder: str, exercise: str) -> str:
    """Return the command that grades a folder."""
    words = ["grader", "run", f"./{folder}" if folder.startswith("-") else folder]
    if exercise != DEFAULT:
        words += ["--exercise", exercise]
    return shlex.join(words)


def _write_sheet(folder: Path, exercise: Exercise, grade: str) -> None:
    manifest = folder / "package.xml"
    text = manifest.read_text(encoding="utf-8", errors="replace") if manifest.is_file() else ""
    package = re.search(r"<name>\s*(\w+)\s*</name>", text)
    to_fill_in = _with_todos(folder)  # what lies in a Python package first
    to_fill_in.sort(key=lambda file: not (folder / file).with_name("__init__.py").exists())
    program = next(iter(to_fill_in), PROGRAM)
    start = Start(program, package[1] if package else "", grade)
    made = sheet(exercise, exercise.subject, start)
    (folder / SHEET).write_text(made, encoding="utf-8")


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
