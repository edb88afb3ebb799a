"""Verdicts before all runs are over: those that the nominal one decides, and no others."""

from __future__ import annotations

import pytest

from grader.exercise import check, early
from grader.exercise.check import Checks
from grader.exercise.loading import load_exercise
from grader.exercise.verdict import Finding
from grader.recording.recording import NominalAlone, NotOver, Recordings
from tests.grader.driving import Spiral, drive


@pytest.fixture(scope="module")
def nominal():
    return drive(Spiral(), ticks=1500)


def early_names(nominal, checks):
    points = dict.fromkeys((check.name for check in checks), 1.0)
    return [verdict.check for verdict in early.judge_nominal(nominal, checks, points, {})]


def test_a_check_that_looks_at_a_varied_run_waits_and_so_does_what_depends_on_it(nominal):
    checks = Checks()

    @checks()
    def alone(recordings, tolerances):
        return Finding(float(recordings.nominal is nominal), "")

    @checks()
    def counts(recordings, tolerances):
        try:
            return Finding(1.0, f"{len(recordings.varied)}")
        except Exception:  # an author's: it must not take the place of an answer
            return Finding(0.0, "")

    @checks()
    def all_of_them(recordings, tolerances):
        return Finding(float(all(r.run.ticks >= 0 for r in recordings)), "")

    @checks(after=("counts",))
    def later(recordings, tolerances):
        return Finding(1.0, "")

    @checks(after=("alone",))
    def sooner(recordings, tolerances):
        return Finding(1.0, "")

    assert early_names(nominal, checks) == ["alone", "sooner"]


def test_one_that_fails_itself_is_left_to_the_judge_of_all(nominal):
    checks = Checks()

    @checks()
    def raises(recordings, tolerances):
        raise ZeroDivisionError

    assert early_names(nominal, checks) == []


def test_what_is_said_early_is_what_is_said_in_the_end(nominal):
    exercise = load_exercise("turtlesim_challenge")
    asked = (exercise.checks, exercise.points, exercise.tolerances)
    first = early.judge_nominal(nominal, *asked)
    whole = check.judge(Recordings(nominal, (nominal, nominal)), *asked)
    assert 1 < len(first) < len(whole)
    assert [verdict for verdict in whole if verdict in first] == first


def test_asking_for_the_others_raises(nominal):
    alone = NominalAlone(nominal)
    assert next(iter(alone)) is nominal
    with pytest.raises(NotOver):
        list(alone)
