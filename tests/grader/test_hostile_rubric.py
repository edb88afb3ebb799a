"""Real submissions that look for points without the work, run for real in virtual time."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests import runs
from tests.runs import CHALLENGE, SUBMISSIONS
from tests.tiers import others_are_more

FOLDER = SUBMISSIONS / "hostile_rubric"
COUNTING = (FOLDER / "dead_reckoning.py").read_text(encoding="utf-8")
WAYS = ("reset", "teleport", "respawn")
DRIVEN = "tests/grader/exercises proves it of each way, without ROS"
#: Who turns without end does so until the run is over: a third of it shows the same.
SHORTER = replace(CHALLENGE, limits=replace(CHALLENGE.limits, total_s=60))


def graded(name):
    """The verdicts of a submission by their checks."""
    return {each.check: each for each in runs.graded(name, SHORTER).verdicts}


@pytest.mark.parametrize("way", others_are_more(DRIVEN, WAYS, "reset"))
def test_who_counts_from_the_centre_shows_nothing_elsewhere(way):
    found = graded(runs.written(COUNTING.replace('WAY = "reset"', f'WAY = "{way}"')))
    assert (found["edge_stop"].score, found["pen_per_quadrant"].score) == (0, 0)
    assert "they do not come from the pose" in str(found["pen_per_quadrant"].rationale)


def test_turns_on_the_spot_make_no_spiral_of_a_line():
    spiral = graded("hostile_rubric/pirouettes")["spiral"]
    assert spiral.score <= 6
    assert "round any centre" in str(spiral.rationale)


def test_judging_ends_for_whoever_turns_without_end():
    assert graded("hostile_rubric/one_command")["spiral"].status == "failed"


def test_a_pen_that_is_up_earns_nothing():
    found = graded("hostile_rubric/pen_up")
    assert (found["pen_per_quadrant"].score, found["picture"].score) == (0, 0)
    assert found["spiral"].status == "passed"
