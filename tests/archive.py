"""One right and one wrong recording of each exercise, for tests of what judges, reports or shows.

They lie in recordings.tar.xz. That they are what a run leaves today shows
tests/grader/test_archive.py, which grades the same hand-ins anew. After a change of runs, or of an
exercise, make the archive anew:

    .venv/bin/python -m tests.archive
"""

import shutil
import tarfile
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache, lru_cache
from importlib import metadata
from pathlib import Path
from typing import Literal

import grader
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.exercise.result.result import Result
from grader.recording import reading, saving
from grader.recording.recording import Recordings
from grader.testing.solutions import Solution, read_solutions
from tests import once
from tests.files import untar

Side = Literal["right", "wrong"]
SIDES: tuple[Side, ...] = ("right", "wrong")
FILE = Path(__file__).with_name("recordings.tar.xz")
EXERCISES = sorted(point.name for point in metadata.entry_points(group="grader.exercises"))
#: Mutants of exercises that come without any.
MUTANTS = {"square": FILE.parent / "grader" / "exercises" / "square_mutants.yaml"}
#: The wrong one, where it is not the first mutant.
WRONG = {
    "follow_me": "stands_still",
    "qos": "first_only",  # the first one has rclpy warn, and that names a line of this release
    "turtlesim_challenge": "two_colours_only",
}
#: So many are kept in memory: some megabytes each.
KEPT = 8


def solution(exercise: Exercise, side: Side) -> Solution:
    """Return the exercise's first right solution, or its mutant in `WRONG`, else its first."""
    solutions = read_solutions(exercise, MUTANTS.get(exercise.name))
    if side == "right":
        return solutions[0]
    mutants = [each for each in solutions if not each.is_right]
    wrong = WRONG.get(exercise.name, mutants[0].name)
    return next(each for each in mutants if each.name == wrong)


@contextmanager
def hand_in(exercise: Exercise, side: Side) -> Iterator[Path]:
    """Lay out the hand-in that was recorded, for as long as the context lasts."""
    with tempfile.TemporaryDirectory() as folder:
        yield solution(exercise, side).lay_out(Path(folder))


def folder(exercise: str, side: Side) -> Path:
    """Return a folder with the recordings, nominal and varied; read it, or copy it."""
    return _unpacked() / exercise / side


@lru_cache(KEPT)
def recordings(exercise: str, side: Side) -> Recordings:
    """Return the recordings of an exercise's right or wrong hand-in."""
    return reading.load_all(folder(exercise, side))


def result(exercise: str, side: Side) -> Result:
    """Judge the recordings of an exercise's right or wrong hand-in."""
    loaded = load_exercise(exercise)
    name = solution(loaded, side).path.name
    return grader.judge(recordings(exercise, side), loaded, submission=name)


@cache
def _unpacked() -> Path:
    def unpack(folder: Path) -> None:
        untar(FILE, folder)

    return once.folder(unpack, "archive", made_by=(str(FILE.relative_to(once.ROOT)),))


def _make(place: Path) -> None:
    """Record every hand-in into a folder, without the files that nobody reads back."""
    for name in EXERCISES:
        exercise = load_exercise(name)
        for side in SIDES:
            with hand_in(exercise, side) as path:
                recorded = grader.record(path, exercise)
            saving.save_all(recorded, place / name / side)
            print(name, side, grader.judge(recorded, exercise).score, flush=True)
    for name in (*saving.PICTURES, saving.SCENARIO):
        for file in place.rglob(name):
            file.unlink()


if __name__ == "__main__":
    made = Path(tempfile.mkdtemp())
    _make(made)
    with tarfile.open(FILE, "w:xz", preset=9) as packed:
        for each in sorted(made.iterdir()):
            packed.add(each, each.name)
    shutil.rmtree(made)
