"""Write the exercise sheet and the starter package of the challenge, or of another exercise."""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from grader.cli import starters as starter
from grader.exercise.loading import load_exercise
from grader.exercise.places import names
from grader.system import files
from grader.system.extensions import DEFAULT_EXERCISE
from grader.text.translations import tr

#: The ROS 2 releases that a starter can be for.
RELEASES = ("humble", "jazzy", "kilted", "lyrical", "rolling")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.epilog = tr("Exercises that are installed: {names}.", names=", ".join(names()))
    parser.add_argument("folder", type=Path, metavar="DIR", help=tr("a new or empty folder"))
    parser.add_argument(
        "--exercise",
        default=DEFAULT_EXERCISE,
        metavar="NAME|FOLDER",
        help=tr("which one (the challenge)"),
    )
    parser.add_argument(
        "--ros",
        choices=RELEASES,
        default=os.environ.get("ROS_DISTRO"),
        help=tr("the ROS 2 release that it is for; default: the sourced one, else as it comes"),
    )


def main(args: argparse.Namespace) -> int:
    """Copy the starter and write the sheet, into a new or empty folder alone."""
    folder: Path = args.folder
    exercise = load_exercise(args.exercise)
    called = folder.resolve().name
    with files.filling(folder) as copy:
        made = starter.write(copy, exercise, args.exercise, called, args.ros)
    if exercise.starter is None:
        print(tr("The exercise sheet is in {folder}.", folder=folder))
    else:
        print(tr("The starter package is in {folder}.", folder=folder))
    if made.package not in ("", called):
        print(tr("The package is called {package}.", package=made.package))
    print(tr("{sheet} says what is asked for and how it is judged.", sheet=starter.SHEET))
    if made.to_fill_in:
        to_fill_in = ", ".join(made.to_fill_in)
        print(tr("Fill in the TODOs of {to_fill_in}, then run:", to_fill_in=to_fill_in))
    else:
        print(tr("Then run:"))
    print(f"    {starter.grading(str(folder), made.words)}")
    return 0
