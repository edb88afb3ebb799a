"""Write the starter package of the challenge."""

from __future__ import annotations

import argparse
import shlex
import shutil
from importlib.resources import as_file, files
from pathlib import Path

from grader.errors import UsageError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument("folder", type=Path, metavar="DIR", help="a new or empty folder")


def main(args: argparse.Namespace) -> int:
    """Copy the starter; nothing that is already there is touched.

    Raises:
        UsageError: the folder holds something, or cannot be written.
    """
    folder: Path = args.folder
    try:
        if folder.exists() and not folder.is_dir():
            raise UsageError(f"{folder} is a file; give a new folder, nothing was written")
        if folder.exists() and any(folder.iterdir()):
            raise UsageError(f"{folder} is not empty; give a new folder, nothing was written")
        with as_file(files("turtlesim_challenge") / "starter") as starter:
            skip = shutil.ignore_patterns("__pycache__", "*.pyc")
            shutil.copytree(starter, folder, dirs_exist_ok=True, ignore=skip)
    except OSError as error:
        raise UsageError(f"cannot write {folder}: {error.strerror}") from None
    print(f"The starter package is in {folder}.")
    print("Fill in the TODOs of turtlesim_challenge/turtle_controller.py, then run:")
    shown = f"./{folder}" if str(folder).startswith("-") else str(folder)
    print(f"    grader run {shlex.quote(shown)}")
    return 0
