"""Real time judges as virtual time does."""

from dataclasses import replace

import pytest

import grader
from grader.run.handover import Plan
from grader.scenes.scene import Limits
from tests import runs
from tests.runs import CHALLENGE

ALONE = replace(CHALLENGE, varied=replace(CHALLENGE.varied, count=0))
#: Those that do not hang on when discovery ends or on how threads race.
REPRODUCIBLE = (
    "quick_spiral",
    "styles/timer",
    "styles/spin_once_loop",
    "styles/rate_with_spin_thread",
)


def verdicts(result: grader.Result) -> dict[str, tuple[str, float]]:
    return {verdict.check: (verdict.status, verdict.score) for verdict in result.verdicts}


@pytest.mark.more("a minute of real time")
@pytest.mark.timeout(300)
@pytest.mark.parametrize("name", REPRODUCIBLE)
def test_real_and_virtual_time_give_the_same_verdicts(name):
    real = grader.grade(runs.path_of(name), ALONE, time="real")
    assert verdicts(real) == verdicts(runs.graded(name, ALONE))


def test_the_reference_is_not_there_to_be_imported():
    path = runs.written("import turtlesim_challenge.turtle_controller\n", "without_a_package.py")
    plan = Plan(Limits(first_motion_s=3, rest_s=1, total_s=3))
    recording = runs.recorded(path, plan)
    assert recording.run.outcome == "crashed"
    assert "ModuleNotFoundError: No module named 'turtlesim_challenge'" in recording.output
