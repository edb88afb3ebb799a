"""What handing in late costs depends on the time, and on nothing else."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta, timezone

import pytest

from grader.exercise.late import Late, LatePolicy

DUE = datetime(2026, 11, 30, 23, 59, tzinfo=timezone(timedelta(hours=1)))
POLICY = LatePolicy(DUE, grace_min=10, per_day=10, most=25)
DAY_S = 86_400


@pytest.mark.parametrize(
    ("after", "expected"),
    [
        (timedelta(days=-3), Late()),
        (timedelta(0), Late()),
        (timedelta(minutes=10), Late(600)),
        (timedelta(minutes=10, microseconds=1), Late(600.000001, 1, 10)),
        (timedelta(days=1, minutes=10), Late(DAY_S + 600, 1, 10)),
        (timedelta(days=1, hours=3), Late(DAY_S + 10_800, 2, 20)),
        (timedelta(days=2, hours=3), Late(2 * DAY_S + 10_800, 3, 25)),
        (timedelta(days=400), Late(400 * DAY_S, 400, 25)),
    ],
)
def test_each_started_day_after_due_and_grace_costs_up_to_the_limit(after, expected):
    assert POLICY.deduction(DUE + after) == expected


def test_a_time_is_the_same_in_any_zone():
    at = DUE + timedelta(hours=5)
    assert POLICY.deduction(at.astimezone(UTC)) == POLICY.deduction(at) == Late(18_000, 1, 10)


def test_a_time_without_a_zone_is_refused():
    with pytest.raises(ValueError, match=r"with its zone, found 2026-12-01T00:00:00"):
        POLICY.deduction(datetime(2026, 12, 1))
