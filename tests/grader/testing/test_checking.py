"""An exercise is tried on its solutions: who catches what, and what is to mend."""

import json

import pytest

from grader.exercise import asking
from grader.exercise.loading import load_exercise
from grader.exercise.places import names
from grader.recording.recording import Recordings
from grader.scenes.turtlesim.driving import twist
from grader.system.limited import WorkLimits
from grader.testing import check_exercise, checking, drive
from grader.testing.checking import examine, odd_recordings
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


@pytest.mark.parametrize(
    ("speeds", "mutants", "told"),
    [
        (
            {"solution": 0.3, "again": 0.3},
            MUTANTS["mutants"],
            ["far: a right solution loses points: It drove 0.30 m. (on solution)"],
        ),
        (
            {},
            {**MUTANTS["mutants"], "fast": {"file": "silent.py"}},
            ["nobody catches a mutant (on fast)"],
        ),
        (
            {"slow": None},
            MUTANTS["mutants"],
            [
                "commands: leaves 0 of 4 points; mutants.yaml says 4 (on slow)",
                "far: leaves 0 of 6 points; mutants.yaml says some (on slow)",
                "far: never fails on any mutant",
            ],
        ),
        ({}, {}, ["there are no mutants in mutants.yaml"]),
        (
            {"again": 1.5},
            MUTANTS["mutants"],
            ["two runs of a right solution are not the same run (on solution)"],
        ),
    ],
)
def test_what_is_wrong_with_solutions_is_told(tmp_path, monkeypatch, driven, speeds, mutants, told):
    monkeypatch.setattr(checking, "odd_recordings", lambda exercise: {})
    driven |= speeds
    found = check_exercise(exercises.write(tmp_path, mutants={**MUTANTS, "mutants": mutants}))
    assert [str(problem.text) for problem in found.problems] == told
    assert found.uncaught == (("fast",) if "fast" in mutants else ())


def test_a_check_that_does_not_survive_what_a_node_can_do_is_told(tmp_path, driven):
    checks = CHECKS.replace("    share =", "    path.x[0]\n    share =")
    (found,) = check_exercise(exercises.write(tmp_path, checks)).problems
    assert str(found.text).startswith("far: checks.py, line 20: IndexError: ")
    assert str(found.text).endswith(
        "(on a node that never sends a number, a node that kills its turtle at once)"
    )


ONE = """from grader import Checks, Evidence, Finding

checks = Checks()
seen = []


@checks()
def only(recordings, tolerances):
    seen.append(1)
    return {result}
"""


def faults(tmp_path, result):
    checks = ONE.format(result=result)
    exercise = load_exercise(exercises.write(tmp_path, checks, points={"only": 1}))
    verdicts, found = examine(exercise, Recordings(drive(lambda *_: None, ticks=5)))
    assert len(verdicts) == 1
    return [str(fault.text) for fault in found]


@pytest.mark.parametrize(
    ("result", "words"),
    [
        ("Finding(1, 'seen')", ""),
        ("Finding(0.5, 'seen', 'look')", ""),
        ("Finding(1, 'seen', evidence=(Evidence(0.08, 'here', 5.5, 5.5),))", ""),
        ("1 / 0", "checks.py, line 10: ZeroDivisionError"),
        ("exit(0)", "checks.py, line 10: SystemExit: 0"),
        ("None", "returns a NoneType; expected a Finding"),
        ("Finding(1, ' ')", "empty rationale"),
        ("Finding(0, 'seen')", "fails without help"),
        ("Finding(len(seen) % 2, 'seen', 'look')", "something else when it is asked again"),
        ("Finding(1, f'{len(seen)} times')", "something else when it is asked again"),
        ("Finding(1, 's', '', (Evidence(0.096, 'n', 1, 1),))", "0.096 s is outside the recording"),
        ("Finding(1, 's', '', (Evidence(0.08, 'n', 1, 12),))", "outside the picture"),
        ("Finding(1, 's', '', (Evidence(0.08, '', 1, 1),))", "empty note"),
    ],
)
def test_a_mistake_is_named_and_what_is_in_order_is_none(tmp_path, result, words):
    found = faults(tmp_path, result)
    assert len(found) == (1 if words else 0)
    assert words in "".join(found)


def test_a_check_without_an_end_is_named_and_no_other_is_blamed(tmp_path, monkeypatch):
    monkeypatch.setattr(asking, "LIMITS", WorkLimits(cpu_s=0.3, wall_s=30.0))
    endless = "\n\n@checks()\ndef endless(recordings, tolerances):\n    while True:\n        pass\n"
    checks = ONE.format(result="Finding(1, 'seen')") + endless
    points = {"only": 1, "endless": 1}
    exercise = load_exercise(exercises.write(tmp_path, checks, points=points))
    _, found = examine(exercise, Recordings(drive(lambda *_: None, ticks=5)))
    assert [fault.check for fault in found] == ["endless"]


@pytest.mark.parametrize(
    "name",
    others_are_more(
        "of each scene one stands for the others",
        names(),
        *{load_exercise(name).scene: name for name in names()}.values(),
    ),
)
def test_our_checks_survive_whatever_a_node_does(name):
    exercise = load_exercise(name)
    recordings = odd_recordings(exercise)
    assert len(recordings) > 10
    faults = {what: examine(exercise, recordings[what])[1] for what in recordings}
    assert {what: found for what, found in faults.items() if found} == {}
