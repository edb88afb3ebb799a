"""Real submissions, run for real in virtual time, get exactly the verdicts they deserve."""

from dataclasses import replace

import pytest

from grader.scenes.turtlesim.interfaces import adapted
from tests import archive, runs
from tests.runs import CHALLENGE, MUTANTS, REFERENCE
from tests.tiers import others_are_more
from turtlesim_py.ros.interfaces import installed

#: Controllers as first-year students write them, each in another style (they are mutated, too, by
#: tests/searches), and the same behaviour by other means of rclpy.
RIGHT = others_are_more(
    "gradings that differ in nothing but the style of the source",
    [
        *(
            f"right/{path.stem}"
            for path in sorted((runs.SUBMISSIONS / "right").iterdir())
            if path.suffix == ".py" or (path / "setup.py").is_file()
        ),
        *("reference", "quick_spiral", "styles/timer", "styles/spin_once_loop"),
        *("styles/multi_threaded", "styles/rate_with_spin_thread"),
    ],
    "right/closures",
)
#: Where the varied runs start, and how fast the turtle is there; None: as the exercise says.
SEEDS = others_are_more("tests/grader/exercises proves it without ROS", (None, 1, 2, 77), 1)
SPOILT = others_are_more(
    "three whole runs of what tests/grader/exercises proves without ROS",
    MUTANTS,
    "crashes_after_six_seconds",
)


def hashes(result):
    return [run.trace_sha256 for run in (result.run, *result.varied_runs)]


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", RIGHT)
def test_a_right_solution_gets_every_point_wherever_it_starts_and_is_blamed_for_nothing(name, seed):
    result = runs.graded(name, seed=seed)
    assert [(v.check, v.rationale) for v in result.verdicts if v.status != "passed"] == []
    assert (result.run.time, result.score, result.diagnosis) == ("virtual", 100, None)


@pytest.mark.applies(len(installed()) == 2, reason="beside a sourced ROS there is one package")
def test_the_reference_for_newer_releases_of_ros_is_as_good_and_makes_the_same_trace():
    newer = runs.graded(runs.written(adapted(REFERENCE.read_text(encoding="utf-8"), "lyrical")))
    assert newer.score == 100
    assert hashes(newer) == hashes(archive.result("turtlesim_challenge", "right"))


@pytest.mark.parametrize("name", SPOILT)
def test_a_mutant_loses_what_it_spoils_and_nothing_else_and_is_told_why(name):
    result = runs.graded(f"mutants/{name}")
    leaves = MUTANTS[name].leaves or {}
    for verdict in result.verdicts:
        assert verdict.rationale
        assert verdict.help or verdict.status == "passed"
        left = leaves.get(verdict.check, 1)
        if left == "some":
            assert 0 < verdict.score < verdict.max_score, verdict
        else:
            assert verdict.score == left * verdict.max_score, verdict
    assert result.diagnosis is not None


#: Who looks for points without the work, and what is left of them at most.
HOSTILE = others_are_more(
    "tests/grader/exercises proves it without ROS",
    [
        ("dead_reckoning", {"edge_stop": 0, "pen_per_quadrant": 0}),
        ("pirouettes", {"spiral": 6}),
        ("one_command", {"spiral": 29}),  # turns until the run is over
        ("pen_up", {"pen_per_quadrant": 0, "picture": 0}),
    ],
    "dead_reckoning",
)
SHORTER = replace(CHALLENGE, limits=replace(CHALLENGE.limits, total_s=60))


@pytest.mark.parametrize(("name", "left"), HOSTILE)
def test_who_looks_for_points_without_the_work_finds_none(name, left):
    result = runs.graded(f"hostile_rubric/{name}", SHORTER)
    scores = {verdict.check: verdict.score for verdict in result.verdicts}
    assert {check: max(scores[check], most) for check, most in left.items()} == left


@pytest.mark.more("tests/grader/test_archive.py finds the hashes of runs that were made long ago")
@pytest.mark.parametrize("name", ["styles/rate_with_spin_thread", "mutants/random_colours"])
def test_the_same_submission_gets_the_same_verdicts_and_the_same_hashes(name):
    first, second = (runs.graded(name, number=number) for number in (1, 2))
    assert (first.verdicts, hashes(first)) == (second.verdicts, hashes(second))
