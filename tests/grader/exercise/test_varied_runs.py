"""How varied runs differ from the nominal one: what an exercise says, and what is drawn."""

import pytest

from grader.errors import ExerciseError
from grader.exercise.loading import load_exercise
from grader.recording.subject import Start
from grader.scenes.turtlesim.driving import twist
from grader.testing import drive
from tests.grader.testing.exercises import edited
from turtlesim_py.world.turtle import SIZE_M

NAME = "turtlesim_challenge"
SAME = {"start": "same", "speed": [1.5, 1.6], "turn": [0.8, 0.9]}


def varied(tmp_path, **runs):
    return load_exercise(edited(tmp_path, varied_runs=runs))


def test_the_seed_draws_factors_from_the_ranges_and_the_place_of_the_nominal_run(tmp_path):
    exercise = varied(tmp_path, count=2, runs=[SAME])
    same, elsewhere = exercise.starts(5)
    assert exercise.starts(5) == [same, elsewhere]
    assert (same.x, same.y, same.theta) == (SIZE_M / 2, SIZE_M / 2, 0.0)
    assert 1.5 <= same.speed <= 1.6
    assert 0.8 <= same.turn <= 0.9
    assert elsewhere.is_as_commanded
    assert exercise.starts(6)[0].speed != same.speed
    assert varied(tmp_path, count=1).starts() == load_exercise(NAME).starts()[:1]
    asked = varied(tmp_path, count=1, runs=[SAME]).conditions
    names = [f"varied_runs.1.{name}" for name in ("same", "speed_from", "turn_to")]
    assert [asked[name] for name in names] == [1, 1.5, 0.9]


@pytest.mark.parametrize(
    ("runs", "words"),
    [
        ("fast", "varied_runs: runs: expected a list of 5000 at most"),
        (
            [{"fast": 1}],
            "varied_runs: runs: expected an object of start, speed, turn, found",
        ),
        (
            [{"start": "home"}],
            "varied_runs: runs: start: expected one of elsewhere, same",
        ),
        ([{"speed": 2}], "varied_runs: runs: speed: expected a list of 5000"),
        ([{"turn": [0.9, 0.8]}], "varied_runs: runs: turn: expected two numbers"),
        ([{"turn": [0, 1]}], "varied_runs: runs: turn: expected two numbers"),
    ],
)
def test_what_cannot_be_drawn_from_is_refused_with_its_line(tmp_path, runs, words):
    with pytest.raises(ExerciseError, match=words):
        varied(tmp_path, count=1, runs=runs)


def test_the_factors_hold_for_every_turtle_and_outlive_reset_kill_and_spawn():
    def controller(tick, pose, arena):
        if tick == 10:
            arena.spawn(2.0, 2.0, 0.0, "other")
        if tick == 20:
            arena.command("other", (1.0, 0.0, 0.0), (0.0, 0.0, 0.5))
        if tick == 30:
            arena.reset()
        if tick == 40:
            arena.kill("turtle1")
            arena.spawn(5.0, 5.0, 0.0, "turtle1")
            twist(arena, 1.0, 0.5)

    trace = drive(controller, 60, Start(3.0, 3.0, 0.0, 1.5, 0.5)).trace
    for name in ("other", "turtle1"):
        way = trace.trajectory(name)
        assert way.linear.max() == 1.5  # the pose says what the turtle does
        assert way.angular.max() == 0.25
