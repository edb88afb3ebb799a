"""Real submissions that look for points without the work, run for real in virtual time."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from grader import grading
from grader.exercise.loading import load_exercise

FOLDER = Path(__file__).parents[1] / "submissions" / "hostile_rubric"
COUNTING = (FOLDER / "dead_reckoning.py").read_text(encoding="utf-8")
WAYS = ("reset", "teleport", "respawn")
CHALLENGE = load_exercise("turtlesim_challenge")
#: Who turns without end does so until the run is over: a third of it shows the same.
SHORTER = replace(CHALLENGE, limits=replace(CHALLENGE.limits, total_s=60))


@pytest.fixture(scope="module")
def graded(tmp_path_factory):
    """Name of a submission -> its verdicts by their checks."""
    folder = tmp_path_factory.mktemp("hostile")
    paths = {name: FOLDER / f"{name}.py" for name in ("pirouettes", "one_command", "pen_up")}
    for way in WAYS:
        paths[way] = folder / f"{way}.py"
        paths[way].write_text(COUNTING.replace('WAY = "reset"', f'WAY = "{way}"'), encoding="utf-8")

    def grade(path):
        return {verdict.check: verdict for verdict in grading.grade(path, SHORTER).verdicts}

    with ThreadPoolExecutor(2) as pool:
        return dict(zip(paths, pool.map(grade, paths.values()), strict=True))


@pytest.mark.timeout(300)
@pytest.mark.parametrize("way", WAYS)
def test_who_counts_from_the_centre_shows_nothing_elsewhere(graded, way):
    found = graded[way]
    assert (found["edge_stop"].score, found["pen_per_quadrant"].score) == (0, 0)
    assert "does not count" in found["edge_stop"].rationale + found["pen_per_quadrant"].rationale


@pytest.mark.timeout(300)
def test_turns_on_the_spot_make_no_spiral_of_a_line(graded):
    assert graded["pirouettes"]["spiral"].score <= 6
    assert "round any centre" in graded["pirouettes"]["spiral"].rationale


@pytest.mark.timeout(300)
def test_judging_ends_for_whoever_turns_without_end(graded):
    assert graded["one_command"]["spiral"].status == "failed"


@pytest.mark.timeout(300)
def test_a_pen_that_is_up_earns_nothing(graded):
    assert (graded["pen_up"]["pen_per_quadrant"].score, graded["pen_up"]["picture"].score) == (0, 0)
    assert graded["pen_up"]["spiral"].status == "passed"
