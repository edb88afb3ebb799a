"""The keys `visible` and `late`: what students see, and what late submissions cost."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Annotated, Any

from grader.exercise.check import Checks
from grader.exercise.verdict import Visible
from grader.system.strict_json import not_negative
from grader.system.yaml_file import Mistake, check_known, decoded

_DAY = timedelta(days=1)


def amount(number: Any) -> float:
    """For `Annotated`: a number from 0."""
    return float(not_negative(number))


Amount = Annotated[float, amount]


@dataclass(frozen=True)
class Late:
    """How late a submission is, and what that costs.

    Attributes:
        late_s: after it was due [s], grace included; 0 where it was in time, or nobody knows.
        days: how many started days of it cost points.
        points: what that costs.
    """

    late_s: float = 0.0
    days: int = 0
    points: float = 0.0


@dataclass(frozen=True)
class LatePolicy:
    """When an exercise is due, and what a later submission costs.

    The cost depends on nothing but the time: not on the score, which could else be concluded from
    it where a part of it is not shown.

    Attributes:
        due: with its time zone.
        grace_min: how long after it costs nothing [minutes]; the first day begins after that.
        per_day: points for each started day of 24 hours.
        most: the limit of these points.
    """

    due: datetime
    grace_min: Amount = 0.0
    per_day: Amount = 0.0
    most: Amount = math.inf

    def deduction(self, at: datetime | None) -> Late:
        """Return what a submission at some time costs; None: it is late, nobody knows how much."""
        if at is None:
            return Late(0.0, 1, round(min(self.per_day, self.most), 2))
        if at.utcoffset() is None:
            raise ValueError(f"expected a time with its zone, found {at.isoformat()}")
        late = at - self.due
        charged = late - timedelta(minutes=self.grace_min)
        days = max(-(-charged // _DAY), 0)
        points = min(days * self.per_day, self.most)
        return Late(max(late.total_seconds(), 0.0), days, round(points, 2))


# The keys of exercise.yaml ------------------------------------------------------------------------

_EXAMPLE = "2026-11-30T23:59:00+01:00"
#: Of two checks the one with the higher number is shown later, or never.
_SHOWN: Mapping[Visible, int] = {"now": 0, "points_only": 0, "after_due": 1, "never": 2}


def visible(given: object, checks: Checks, points: Mapping[str, float]) -> dict[str, Visible]:
    """Parse `visible`: check name -> what students see of it, for those that the file names.

    Raises:
        Mistake: a name or a value is none, or a check would reveal one that is not shown yet.
    """
    found = decoded(Mapping[str, Any], given or {}, "visible")
    check_known(found, [check.name for check in checks], ("visible",), are_checks=True)
    seen = {name: decoded(Visible, value, "visible", name) for name, value in found.items()}
    _check_order(seen, checks, points)
    return seen


def _check_order(given: Mapping[str, Visible], checks: Checks, points: Mapping[str, float]) -> None:
    """Refuse a check that is shown before one that it depends on: "not judged" reveals that."""
    for check in checks:
        for other in check.depends_on:
            if not {check.name, other} <= points.keys():
                continue
            seen, hidden = given.get(check.name, "now"), given.get(other, "now")
            if _SHOWN[seen] < _SHOWN[hidden]:
                raise Mistake(
                    ("visible", other),
                    "{hidden}, but {name}, which is judged only where {other} passed, "
                    "is {seen} and would tell of it; make {name} {hidden} as well",
                    hidden=hidden,
                    name=repr(check.name),
                    other=repr(other),
                    seen=seen,
                )


def late(given: object, max_score: float) -> LatePolicy | None:
    """Parse `late`: what late submissions cost; None where the file has no such key.

    Raises:
        Mistake: something of it cannot be used.
    """
    if given is None:
        return None
    if isinstance(given, dict) and "due" in given:
        given = {"most": max_score, **given, "due": _due(given["due"]).isoformat()}
    policy: LatePolicy = decoded(LatePolicy, given, "late")
    return policy


def _due(given: object) -> datetime:
    found = given
    if isinstance(given, str):
        try:
            found = datetime.fromisoformat(given)
        except ValueError:
            found = None
    if not isinstance(found, datetime) or found.utcoffset() is None:
        raise Mistake(
            ("late", "due"),
            "expected a date, a time and its zone, e.g. {example}; found {shown}",
            example=_EXAMPLE,
            shown=str(given),
        )
    return found
