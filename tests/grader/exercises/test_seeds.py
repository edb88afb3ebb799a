"""Right hand-ins keep every point, whatever is drawn and wherever a turtle starts."""

import pytest

import grader
from grader.exercise import places
from grader.exercise.loading import load_exercise
from grader.testing.solutions import FILE_NAME, read_solutions
from tests.hand_ins import SUBMISSIONS

pytestmark = [
    pytest.mark.timeout(3600),
    pytest.mark.more("tests/grader/testing/test_parrot.py grades each reference"),
]
FOLDERS = {
    "turtlesim_challenge": SUBMISSIONS / "right",
    "square": SUBMISSIONS / "squares" / "right",
}
EXERCISES = {
    name: exercise
    for name in places.names()
    if (exercise := load_exercise(name)).is_started and exercise.has_chance
}


def styles(name):
    """The reference, and three others."""
    exercise = EXERCISES[name]
    own = read_solutions(exercise) if (exercise.folder / FILE_NAME).is_file() else ()
    folder = FOLDERS.get(name, SUBMISSIONS / "tutorials" / name / "right")
    others = sorted(folder.iterdir()) if folder.is_dir() else ()
    return [*(each.path for each in own if each.is_right), *others][:4]


@pytest.mark.parametrize("name", EXERCISES)
def test_ten_seeds_of_four_right_hand_ins_cost_nothing(name):
    paths, exercise = styles(name), EXERCISES[name]
    assert len(paths) == 4
    scores = {
        (p.name, s): grader.grade(p, exercise, seed=s).score for p in paths for s in range(10)
    }
    assert {key: score for key, score in scores.items() if score < 100} == {}
