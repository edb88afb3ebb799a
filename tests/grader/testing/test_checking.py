"""An exercise is tried on its solutions: who catches what, and what is to mend."""

from __future__ import annotations

import json

import pytest

from grader.exercise.loading import load_exercise
from grader.recording.recording import Recordings
from grader.testing import check_exercise, checking, drive, twist
from tests.grader.language.holes import holes
from tests.grader.testing import exercises
from tests.grader.testing.exercises import CHECKS, MUTANTS
from tests.tiers import others_are_more


def driver(speed):
    def controller(tick, pose, arena):
        if tick == 1 and speed is not None:
            twist(arena, speed, 0.0)

    return controller


SPEEDS = {"again": 1.0, "solution": 1.0, "slow": 0.1, "silent": None, "fast": 2.0}


@pytest.fixture
def driven(monkeypatch):
    """Runs without ROS: a function drives as the solution of the same name would."""
    speeds = dict(SPEEDS)

    def run(exercise, solutions, jobs, progress):
        wanted = ["again", *(solution.name for solution in solutions)]
        return {name: Recordings(drive(driver(speeds[name]), 300)) for name in wanted}

    monkeypatch.setattr(checking, "_run", run)
    return speeds


def problems(folder):
    return [str(problem) for problem in check_exercise(folder).problems]


def test_an_exercise_that_is_in_order_has_no_problems_and_a_table(tmp_path, driven):
    found = check_exercise(load_exercise(exercises.write(tmp_path)))
    assert found.is_fine
    assert found.catches == {"commands": ("silent",), "far": ("slow",)}
    assert found.uncaught == ()
    assert found.to_markdown().splitlines() == [
        "|  | `commands` | `far` | caught by |",
        "| --- | --- | --- | ---: |",
        "| `solution` |  |  | right |",
        "| `slow` |  | **20 %** | 1 |",
        "| `silent` | **0 %** | – | 1 |",
        "| catches | 1 | 1 | 2 of 2 |",
    ]
    data = json.loads(json.dumps(found.to_json()))
    assert (data["fine"], data["catches"]["far"]) == (True, ["slow"])
    assert data["solutions"][2]["checks"]["far"]["status"] == "not_judged"


def test_a_right_solution_that_loses_points_is_told(tmp_path, driven):
    driven["solution"] = driven["again"] = 0.3
    found = problems(exercises.write(tmp_path))
    assert found == ["far: a right solution loses points: It drove 0.30 m. (on solution)"]


def test_a_mutant_that_nobody_catches_is_told(tmp_path, driven):
    mutants = {**MUTANTS["mutants"], "fast": {"file": "silent.py"}}
    folder = exercises.write(tmp_path, mutants={**MUTANTS, "mutants": mutants})
    assert problems(folder) == ["nobody catches a mutant (on fast)"]
    assert check_exercise(folder).uncaught == ("fast",)


def test_what_is_left_of_the_points_must_be_what_was_said(tmp_path, driven):
    driven["slow"] = None
    assert problems(exercises.write(tmp_path)) == [
        "commands: leaves 0 of 4 points; mutants.yaml says 1 of them (on slow)",
        "far: leaves 0 of 6 points; mutants.yaml says some (on slow)",
        "far: never fails on any mutant",
    ]


@pytest.mark.parametrize("language", others_are_more("as French", ["fr", "zh"], "fr"))
def test_what_is_to_mend_is_told_in_the_readers_language(language, tmp_path, driven):
    driven["slow"] = None
    driven["again"] = 1.5
    found = check_exercise(exercises.write(tmp_path)).problems
    assert len(found) == 4
    assert [hole for each in found for hole in holes(str(each), language)] == []


def test_an_exercise_without_mutants_is_told(tmp_path, driven):
    folder = exercises.write(tmp_path, mutants={"right": {"solution": "solution.py"}})
    assert problems(folder) == ["there are no mutants in mutants.yaml"]


def test_two_runs_that_are_not_the_same_are_told(tmp_path, driven):
    driven["again"] = 1.5
    found = problems(exercises.write(tmp_path))
    assert found == ["two runs of a right solution are not the same run (on solution)"]


def test_a_check_that_does_not_survive_what_a_node_can_do_is_told(tmp_path, driven):
    checks = CHECKS.replace("    share =", "    path.x[0]\n    share =")
    (found,) = problems(exercises.write(tmp_path, checks))
    assert found.startswith("far: raises checks.py, line 20: IndexError: ")
    assert found.endswith(
        "(on a node that never sends a number, a node that kills its turtle at once)"
    )
