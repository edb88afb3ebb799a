"""Right hand-ins of exercises, of different styles."""

from pathlib import Path

from grader.exercise.exercise import Exercise
from grader.testing.solutions import FILE_NAME, read_solutions
from tests.hand_ins import SUBMISSIONS

FOLDERS = {
    "turtlesim_challenge": SUBMISSIONS / "right",
    "square": SUBMISSIONS / "squares" / "right",
}


def right(exercise: Exercise) -> list[Path]:
    """The solutions that the exercise comes with, and others; four at most."""
    is_there = (exercise.folder / FILE_NAME).is_file()
    own = [each.path for each in read_solutions(exercise) if each.is_right] if is_there else []
    folder = FOLDERS.get(exercise.name, SUBMISSIONS / "tutorials" / exercise.name / "right")
    return [*own, *sorted(folder.glob("*"))][:4]
