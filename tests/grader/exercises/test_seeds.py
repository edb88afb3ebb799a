"""Right hand-ins keep every point, whatever is drawn and wherever a turtle starts."""

import pytest

import grader
from grader.exercise import places
from grader.exercise.loading import load_exercise
from tests.grader.exercises import solutions

pytestmark = [
    pytest.mark.timeout(3600),
    pytest.mark.more("tests/grader/testing/test_parrot.py records each reference"),
]
EXERCISES = {
    name: exercise
    for name in places.names()
    if (exercise := load_exercise(name)).is_started and exercise.has_chance
}


@pytest.mark.parametrize("name", EXERCISES)
def test_ten_seeds_of_four_right_hand_ins_cost_nothing(name):
    exercise = EXERCISES[name]
    paths = solutions.right(exercise)
    assert len(paths) == 4
    scores = {
        (p.name, s): grader.grade(p, exercise, seed=s).score for p in paths for s in range(10)
    }
    assert {key: score for key, score in scores.items() if score < 100} == {}
