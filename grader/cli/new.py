"""Write the starter package of the challenge, or of another exercise."""

from __future__ import annotations

import argparse
import os
import shlex
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from grader.errors import UsageError
from grader.exercise import DEFAULT
from grader.exercise.loading import load_exercise
from grader.scenes import load_scene
from grader.scenes.scene import Scene

#: The ROS 2 releases that a starter can be for.
RELEASES = ("humble", "jazzy", "kilted", "lyrical", "rolling")
#: What of a starter depends on the release.
ADAPTED = ("*.py", "package.xml")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    parser.add_argument("folder", type=Path, metavar="DIR", help="a new or empty folder")
    parser.add_argument(
        "--exercise", default=DEFAULT, metavar="NAME|FOLDER", help="whose starter (the challenge's)"
    )
    parser.add_argument(
        "--ros",
        choices=RELEASES,
        default=os.environ.get("ROS_DISTRO"),
        help="the ROS 2 release that it is for; default: the sourced one, else as it comes",
    )


def main(args: argparse.Namespace) -> int:
    """Copy the starter; nothing that is already there is touched.

    Raises:
        UsageError: the folder holds something, or cannot be written; the exercise has no starter.
    """
    folder: Path = args.folder
    exercise = load_exercise(args.exercise)
    starter = exercise.starter
    if starter is None:
        raise UsageError(f"the exercise {args.exercise!r} has no starter; nothing was written")
    try:
        if folder.exists() and not folder.is_dir():
            raise UsageError(f"{folder} is a file; give a new folder, nothing was written")
        if folder.exists() and any(folder.iterdir()):
            raise UsageError(f"{folder} is not empty; give a new folder, nothing was written")
        with _whole_or_not_at_all(folder) as copy:
            skip = shutil.ignore_patterns("__pycache__", "*.pyc")
            shutil.copytree(starter, copy, ignore=skip)
            if args.ros:
                _adapt(copy, load_scene(exercise.scene), args.ros)
    except shutil.Error as error:
        source, _, why = error.args[0][0]  # (source, target, why) of each file
        raise UsageError(f"cannot copy {source}: {why}; nothing was written") from None
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


@contextmanager
def _whole_or_not_at_all(folder: Path) -> Iterator[Path]:
    """A place for a copy, which comes into the folder when it is whole; else nothing is left."""
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


def _adapt(folder: Path, scene: Scene, ros_distro: str) -> None:
    """Give the files the names that things have in a ROS 2 release."""
    for path in (path for pattern in ADAPTED for path in folder.rglob(pattern)):
        text = path.read_bytes().decode("utf-8", "surrogateescape")
        path.write_bytes(scene.adapted(text, ros_distro).encode("utf-8", "surrogateescape"))


def _with_todos(folder: Path) -> list[str]:
    """The Python files that leave something to do."""
    found = (path for path in sorted(folder.rglob("*.py")) if b"TODO" in path.read_bytes())
    return [str(path.relative_to(folder)) for path in found]
