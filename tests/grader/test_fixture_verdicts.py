"""Real submissions, run for real in virtual time, get exactly the verdicts they deserve.

All of them are graded first, two at a time; then each has a test of its own.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from grader.diagnosis.diagnose import diagnose
from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.grading import run_all
from grader.run import virtual_time
from grader.scenes.turtlesim.interfaces import adapted
from grader.submission.opening import open_submission
from tests.submissions.mutants import MUTANTS, REFERENCE
from turtlesim_py.ros.interfaces import installed

SUBMISSIONS = Path(__file__).parents[1] / "submissions"
RIGHT = {
    "reference": REFERENCE,
    "quick_spiral": SUBMISSIONS / "quick_spiral.py",
    **{
        style: SUBMISSIONS / "styles" / f"{style}.py"
        for style in (
            "timer",  # ... and all that draw the same, which tests/grader/run says
            "spin_once_loop",
            "multi_threaded",
            "rate_with_spin_thread",
        )
    },
}
#: The reference as it is written for ROS 2 from Kilted on.
NEWER = "reference_for_lyrical"
#: Mutants whose runs show what is wrong, whatever was asked for.
SHOWS_BY_ITSELF = {
    "wrong_topic": "publishes_to_nobody",
    "wrong_type": "publishes_to_nobody",
    "wrong_turtle": "publishes_to_nobody",
    "crashes_after_six_seconds": "crashed",
    "crashes_after_ten_seconds": "crashed",
    "never_spins": "never_spins",
}
#: Graded a second time, to see that nothing changes.
TWICE = ("reference", "rate_with_spin_thread", "random_colours", "draws_by_teleport")


@pytest.fixture(scope="module")
def graded(tmp_path_factory):
    """Name of a submission -> its verdicts, hashes, and diagnosis, once for each grading."""
    folder = tmp_path_factory.mktemp("mutants")
    paths = dict(RIGHT)
    texts = {name: mutant.text() for name, mutant in MUTANTS.items()}
    if len(installed()) == 2:
        texts[NEWER] = adapted(REFERENCE.read_text(encoding="utf-8"), "lyrical")
    for name, text in texts.items():
        paths[name] = folder / name / "turtle_controller.py"
        paths[name].parent.mkdir()
        paths[name].write_text(text, encoding="utf-8")
    exercise = load_exercise("turtlesim_challenge")

    def grade_one(name):
        with open_submission(paths[name]) as submission:
            recordings = run_all(submission, exercise, virtual_time.run)
        verdicts = judge(recordings, exercise.checks, exercise.points, exercise.tolerances)
        hashes = [recording.run.trace_sha256 for recording in recordings]
        assert all(recording.run.time == "virtual" for recording in recordings)
        return verdicts, hashes, diagnose(recordings)

    with ThreadPoolExecutor(2) as pool:
        tasks = {name: [pool.submit(grade_one, name)] for name in paths}
        for name in TWICE:
            tasks[name].append(pool.submit(grade_one, name))
        return {name: [task.result() for task in both] for name, both in tasks.items()}


def scores(verdicts):
    return {verdict.check: verdict.score for verdict in verdicts}


@pytest.mark.timeout(600)
@pytest.mark.parametrize("name", RIGHT)
def test_a_right_solution_gets_every_point(graded, name):
    verdicts, *_ = graded[name][0]
    assert [(v.check, v.rationale) for v in verdicts if v.status != "passed"] == []


@pytest.mark.timeout(600)
@pytest.mark.skipif(len(installed()) < 2, reason="beside a sourced ROS there is one package")
def test_the_reference_for_newer_releases_of_ros_is_as_good_and_makes_the_same_trace(graded):
    assert graded[NEWER][0] == graded["reference"][0]
    assert sum(verdict.score for verdict in graded[NEWER][0][0]) == 100


@pytest.mark.timeout(600)
@pytest.mark.parametrize("name", MUTANTS)
def test_a_mutant_loses_what_it_spoils_and_nothing_else(graded, name):
    verdicts, *_ = graded[name][0]
    lost = MUTANTS[name].lost
    for verdict in verdicts:
        expected = lost.get(verdict.check, verdict.max_score)
        if expected == "some":
            assert 0 < verdict.score < verdict.max_score, verdict
        else:
            assert verdict.score == expected, verdict


@pytest.mark.parametrize("name", MUTANTS)
def test_a_failed_verdict_explains_itself(graded, name):
    verdicts, *_ = graded[name][0]
    for verdict in verdicts:
        assert verdict.rationale
        assert verdict.help or verdict.status == "passed"


@pytest.mark.parametrize("name", [*RIGHT, *MUTANTS])
def test_a_run_is_diagnosed_only_where_it_shows_a_cause_by_itself(graded, name):
    """It comes before the findings of all checks: it must be sure."""
    _, _, found = graded[name][0]
    assert (found and found.key) == SHOWS_BY_ITSELF.get(name), found


@pytest.mark.parametrize("name", TWICE)
def test_the_same_submission_gets_the_same_verdicts_and_the_same_hashes(graded, name):
    first, second = graded[name]
    assert first == second
