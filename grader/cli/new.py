"""Write the starter package of the challenge, or of another exercise."""

from __future__ import annotations

import argparse
import shlex
import shutil
from pathlib import Path

from grader.errors import UsageError
from grader.exercise.loading import DEFAULT, load_exercise


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument("folder", type=Path, metavar="DIR", help="a new or empty folder")
    parser.add_argument(
        "--exercise", default=DEFAULT, metavar="NAME|FOLDER", help="whose starter (the challenge's)"
    )


def main(args: argparse.Namespace) -> int:
    """Copy the starter; nothing that is already there is touched.

    Raises:
        UsageError: the folder holds something, or cannot be written; the exercise has no starter.
    """
    folder: Path = args.folder
    starter = load_exercise(args.exercise).starter
    if starter is None:
        raise UsageError(f"the exercise {args.exercise!r} has no starter; nothing was written")
    try:
        if folder.exists() and not folder.is_dir():
            raise UsageError(f"{folder} is a file; give a new folder, nothing was written")
        if folder.exists() and any(folder.iterdir()):
            raise UsageError(f"{folder} is not empty; give a new folder, nothing was written")
        skip = shutil.ignore_patterns("__pycache__", "*.pyc")
        shutil.copytree(starter, folder, dirs_exist_ok=True, ignore=skip)
    except OSError as error:
        raise UsageError(f"cannot write {folder}: {error.strerror}") from None
    print(f"The starter package is in {folder}.")
    to_fill_in = _with_todos(folder)
    if to_fill_in:
        print(f"Fill in the TODOs of {', '.join(to_fill_in)}, then run:")
    else:
        print("Then run:")
    words = ["grader", "run", f"./{folder}" if str(folder).startswith("-") else str(folder)]
    if args.exercise != DEFAULT:
        words += ["--exercise", args.exercise]
    print(f"    {shlex.join(words)}")
    return 0


def _with_todos(folder: Path) -> list[str]:
    """The Python files that leave something to do."""
    found = (path for path in sorted(folder.rglob("*.py")) if b"TODO" in path.read_bytes())
    return [str(path.relative_to(folder)) for path in found]
