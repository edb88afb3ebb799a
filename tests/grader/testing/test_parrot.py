"""Who only repeats what a right solution has sent earns nothing but what is excused by name."""

import pytest

from grader.exercise.loading import load_exercise
from grader.exercise.places import names
from grader.grading import record
from grader.judging import judge
from grader.testing import parrot
from grader.testing.checking import BY_CHANCE
from grader.testing.solutions import FILE_NAME, read_solutions
from tests.grader.exercises import solutions
from tests.tiers import others_are_more

#: The exercises in which something has to be heard, and what a parrot has there [points].
EARNED = {
    "action_client": 25,
    "action_server": 20,
    "catch_them_all": 25,
    "follow_me": 10,
    "listener": 20,
    "own_interfaces": 60,
    "parameters": 25,
    "qos": 0,
    "service_client": 0,
    "service_server": 0,
    "talker": 100,
    "talker_listener": 80,
    "tf2_broadcaster": 0,
    "tf2_listener": 20,
    "tf2_static_broadcaster": 0,
    "turtle_service": 10,
}


def test_all_exercises_with_a_program_and_a_solution_are_tried():
    loaded = map(load_exercise, names())
    tried = {e.name for e in loaded if e.is_started and (e.folder / FILE_NAME).is_file()}
    assert {*EARNED} <= tried


STYLES = {
    f"{name}, {path.name}": (name, path)
    for name in EARNED
    for path in solutions.right(load_exercise(name))
}


@pytest.mark.parametrize(
    ("key", "name", "path"),
    others_are_more(
        "a parrot of each exercise is one of its first right solution",
        [(key, *each) for key, each in STYLES.items()],
        *(f"{name}, {solutions.right(load_exercise(name))[0].name}" for name in EARNED),
    ),
)
def test_a_parrot_has_what_needs_nothing_heard_and_no_more(key, name, path, tmp_path):
    exercise = load_exercise(name)
    parroted = parrot.record(path, exercise, record(path, exercise), tmp_path)
    verdicts = judge(parroted, exercise).verdicts
    excused = {check.name for check in exercise.checks if check.parrot}
    by_chance = [v.score / v.max_score for v in verdicts if v.check not in excused and v.max_score]
    assert max(by_chance, default=0) <= BY_CHANCE
    assert sum(v.score for v in verdicts if v.check in excused) <= EARNED[name]


def test_a_parrot_hears_nothing(tmp_path):
    exercise = load_exercise("listener")
    path = read_solutions(exercise)[0].path
    text = parrot.source(record(path, exercise).nominal, path.name)
    assert "create_subscription" not in text
    assert "I heard" in text
