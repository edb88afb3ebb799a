"""Real submissions, run for real in virtual time, get exactly the verdicts they deserve."""

from __future__ import annotations

from functools import cache

import pytest

from grader.diagnosis.diagnose import diagnose
from grader.exercise.check import judge
from grader.scenes.turtlesim.interfaces import adapted
from tests import runs
from tests.runs import CHALLENGE, MUTANTS, REFERENCE
from tests.tiers import others_are_more
from turtlesim_py.ros.interfaces import installed

RIGHT = others_are_more(
    "they draw the same as `quick_spiral`, which tests/grader/run proves",
    (
        *("reference", "quick_spiral", "styles/timer", "styles/spin_once_loop"),
        *("styles/multi_threaded", "styles/rate_with_spin_thread"),
    ),
    *("reference", "quick_spiral"),
)
#: Controllers as first-year students write them, each in another style; they are mutated, too, by
#: tests/searches.
OF_STUDENTS = others_are_more(
    "four gradings each, which differ in nothing but the style of the source",
    [
        f"right/{path.stem}"
        for path in sorted((runs.SUBMISSIONS / "right").iterdir())
        if path.suffix == ".py" or (path / "setup.py").is_file()
    ],
    *("right/closures", "right/with_launch_file"),
)
#: Where the varied runs start, and how fast the turtle is there; None: as the exercise says.
SEEDS = (None, 1, 2, 77)
#: Mutants whose runs show what is wrong, whatever was asked for.
SHOWS_BY_ITSELF = {
    "wrong_topic": "publishes_to_nobody",
    "wrong_type": "publishes_to_nobody",
    "wrong_turtle": "publishes_to_nobody",
    "crashes_after_six_seconds": "crashed",
    "crashes_after_ten_seconds": "crashed",
    "never_spins": "never_spins",
}
SPOILT = others_are_more(
    "three whole runs of what tests/grader/exercises proves without ROS; of each check one stays",
    [f"mutants/{name}" for name in MUTANTS],
    *("mutants/stops_in_the_middle", "mutants/drives_irregularly", "mutants/two_colours_only"),
    *("mutants/pen_off", "mutants/wrong_topic", "mutants/never_spins"),
    "mutants/crashes_after_six_seconds",
)
#: Graded a second time, to see that nothing changes.
TWICE = others_are_more(
    "its colours are those of a seeded random",
    ("styles/rate_with_spin_thread", "mutants/random_colours"),
    "styles/rate_with_spin_thread",
)


@cache
def graded(name, number=1):
    """The verdicts, hashes and diagnosis of a grading."""
    recordings = runs.recordings(name, number=number)
    assert all(recording.run.time == "virtual" for recording in recordings)
    verdicts = judge(recordings, CHALLENGE.checks, CHALLENGE.points, CHALLENGE.tolerances)
    return verdicts, [each.run.trace_sha256 for each in recordings], diagnose(recordings)


@pytest.mark.parametrize("name", RIGHT)
def test_a_right_solution_gets_every_point(name):
    verdicts, *_ = graded(name)
    assert [(v.check, v.rationale) for v in verdicts if v.status != "passed"] == []


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", OF_STUDENTS)
def test_a_right_solution_of_a_student_gets_every_point_wherever_it_starts(name, seed):
    result = runs.graded(name, seed=seed)
    assert [(v.check, v.rationale) for v in result.verdicts if v.status != "passed"] == []
    assert result.score == 100


@pytest.mark.applies(len(installed()) == 2, reason="beside a sourced ROS there is one package")
def test_the_reference_for_newer_releases_of_ros_is_as_good_and_makes_the_same_trace():
    newer = runs.written(adapted(REFERENCE.read_text(encoding="utf-8"), "lyrical"))
    assert graded(newer) == graded("reference")
    assert sum(verdict.score for verdict in graded(newer)[0]) == 100


@pytest.mark.parametrize("name", SPOILT)
def test_a_mutant_loses_what_it_spoils_and_nothing_else(name):
    verdicts, *_ = graded(name)
    leaves = MUTANTS[name.removeprefix("mutants/")].leaves or {}
    for verdict in verdicts:
        left = leaves.get(verdict.check, 1)
        if left == "some":
            assert 0 < verdict.score < verdict.max_score, verdict
        else:
            assert verdict.score == left * verdict.max_score, verdict


@pytest.mark.parametrize("name", SPOILT)
def test_a_failed_verdict_explains_itself(name):
    verdicts, *_ = graded(name)
    for verdict in verdicts:
        assert verdict.rationale
        assert verdict.help or verdict.status == "passed"


@pytest.mark.parametrize("name", [*RIGHT, *SPOILT])
def test_a_run_is_diagnosed_only_where_it_shows_a_cause_by_itself(name):
    """It comes before the findings of all checks: it must be sure."""
    _, _, found = graded(name)
    assert (found and found.key) == SHOWS_BY_ITSELF.get(name.removeprefix("mutants/")), found


@pytest.mark.parametrize("name", TWICE)
def test_the_same_submission_gets_the_same_verdicts_and_the_same_hashes(name):
    assert graded(name) == graded(name, number=2)
