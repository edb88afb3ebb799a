"""Whose a result is, and what is left of its score when it came late."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

import pytest

from grader.exercise.late import LatePolicy
from grader.result.handed_in import HandedIn
from grader.result.result import Result
from grader.strict_json import to_json
from tests.grader.reports import samples

DUE = datetime(2026, 11, 30, 22, 59, tzinfo=UTC)
POLICY = LatePolicy(DUE, 10, 10, 50)
LATE = HandedIn.of("4711", "Zoë Müller", 2, DUE + timedelta(days=1, hours=3), POLICY)


def with_it(handed_in, **more):
    return Result.from_json(samples.result(**more) | {"handed_in": to_json(handed_in)})


def test_a_result_keeps_whose_it_is():
    assert (LATE.at, LATE.late_s) == ("2026-12-02T01:59:00+00:00", 97_200)
    assert (LATE.days, LATE.deducted) == (2, 20)
    result = with_it(LATE)
    assert result.handed_in == LATE
    assert Result.from_file(result.to_json()) == result


@pytest.mark.parametrize(("score", "final"), [(87.5, 67.5), (20, 0), (3.25, 0)])
def test_the_final_score_is_what_lateness_leaves_and_never_below_nothing(score, final):
    listed = [samples.verdict("a", "failed", score, max_score=100)]
    result = Result.from_json(samples.result(*listed) | {"handed_in": to_json(LATE)})
    assert (result.score, result.final) == (score, final)


def test_without_a_hand_in_or_a_policy_the_score_is_final():
    assert Result.from_json(samples.result()).final == 18.33
    assert with_it(HandedIn.of("4711", "", 1, None, POLICY)).final == 18.33
    assert with_it(HandedIn.of("4711", "", 1, DUE, None)).final == 18.33


def test_it_costs_what_the_exercise_says_now():
    assert LATE.by(LatePolicy(DUE, 0, 1, 50)).deducted == 2
    assert LATE.by(None).deducted == 0


@pytest.mark.parametrize("at", ["2026-12-02T01:59:00", "soon"])
def test_a_time_without_a_zone_is_no_time(at):
    data = samples.result() | {"handed_in": to_json(LATE) | {"at": at}}
    with pytest.raises(ValueError, match=at):
        Result.from_json(data)
