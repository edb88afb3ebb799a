"""How checks become verdicts."""

from __future__ import annotations

import pytest

from grader.errors import CheckFailed
from grader.exercise.check import Checks, judge
from grader.exercise.verdict import Finding
from grader.recording.recording import Recordings
from grader.testing import drive


def verdicts(checks, points):
    recording = drive(lambda *_: None, ticks=2)
    return {v.check: v for v in judge(Recordings(recording), checks, points, {"limit": 3})}


def an_exercise(share):
    checks = Checks()

    @checks()
    def first(recordings, tolerances):
        """The first thing.

        More about it.
        """
        return Finding(share, "seen", "look", ())

    @checks(after=("first",))
    def second(recordings, tolerances):
        """The second thing."""
        return Finding(1, f"the limit is {tolerances['limit']}")

    return checks


def test_a_whole_share_passes_and_the_docstrings_first_line_is_the_title():
    first = verdicts(an_exercise(1), {"first": 4})["first"]
    assert (first.status, first.score, first.title) == ("passed", 4, "The first thing")


def test_a_part_of_the_share_fails_with_that_part_of_the_points_and_help():
    first = verdicts(an_exercise(0.25), {"first": 4})["first"]
    assert (first.status, first.score, first.help) == ("failed", 1, "look")


def test_what_depends_on_a_failed_check_is_not_judged_and_says_for_which_it_waited():
    second = verdicts(an_exercise(0.5), {"first": 4, "second": 6})["second"]
    assert (second.status, second.score, second.max_score) == ("not_judged", 0, 6)
    assert "'first'" in second.rationale


def test_a_check_reads_the_exercises_tolerances():
    second = verdicts(an_exercise(1), {"first": 1, "second": 6})["second"]
    assert second.rationale == "the limit is 3"


def test_a_check_without_points_is_not_run():
    assert list(verdicts(an_exercise(1), {"second": 6})) == ["second"]


def test_points_for_an_unknown_check_are_an_error():
    with pytest.raises(KeyError, match="no check is named 'third'"):
        verdicts(an_exercise(1), {"third": 1})


def test_a_dependency_that_is_not_defined_above_is_an_error():
    with pytest.raises(ValueError, match="no check above is named frist"):
        Checks()(after=("frist",))


def test_an_exception_in_a_check_is_the_exercise_s_with_its_file_and_line():
    checks = Checks()

    @checks()
    def divides(recordings, tolerances):
        """It divides."""
        return Finding(1 / 0, "never")

    with pytest.raises(CheckFailed) as error:
        verdicts(checks, {"divides": 1})
    assert (error.value.whose, error.value.exit_code) == ("exercise", 3)
    assert "'divides' failed itself" in error.value.message
    assert "test_check.py, line" in error.value.message
    assert error.value.message.endswith("ZeroDivisionError: division by zero")
