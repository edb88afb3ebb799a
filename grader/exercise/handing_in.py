"""What exercise.yaml says beside judging: what students see of it, and what late hand-ins cost."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from typing import Any, get_args

from grader.exercise.check import Checks
from grader.exercise.late import LatePolicy
from grader.exercise.verdict import Visible
from grader.exercise.yaml_file import Mistake, did_you_mean, is_amount
from grader.language.phrase import say

VISIBLE = get_args(Visible)
LATE = ("due", "grace_min", "per_day", "most")
_EXAMPLE = "2026-11-30T23:59:00+01:00"
#: Of two checks the one with the higher number is shown later, or never.
_SHOWN: Mapping[Visible, int] = {"now": 0, "points_only": 0, "after_due": 1, "never": 2}


def visible(given: object, checks: Checks, points: Mapping[str, float]) -> dict[str, Visible]:
    """Check name -> what students see of it, for those that the file names.

    Raises:
        Mistake: a name or a value is none, or a check would tell of one that is not shown yet.
    """
    if given is None:
        return {}
    if not isinstance(given, dict):
        text = say(
            "expected check names, each with one of {visible}; found {given}",
            visible=", ".join(VISIBLE),
            given=repr(given),
        )
        raise Mistake(("visible",), text)
    known = [check.name for check in checks]
    for name, value in given.items():
        if name not in known:
            text = say(
                "no check is named {name}; {hint}",
                name=repr(name),
                hint=did_you_mean(name, known),
            )
            raise Mistake(("visible",), text)
        if value not in VISIBLE:
            text = say(
                "expected one of {visible}; found {value}",
                visible=", ".join(VISIBLE),
                value=repr(value),
            )
            raise Mistake(("visible", str(name)), text)
    _check_order(given, checks, points)
    return dict(given)


def _check_order(given: Mapping[str, Visible], checks: Checks, points: Mapping[str, float]) -> None:
    """Refuse a check that is shown before one that it depends on: "not judged" tells of that."""
    for check in checks:
        for other in check.depends_on:
            if not {check.name, other} <= points.keys():
                continue
            seen, hidden = given.get(check.name, "now"), given.get(other, "now")
            if _SHOWN[seen] < _SHOWN[hidden]:
                raise Mistake(
                    ("visible", other),
                    say(
                        "{hidden}, but {name}, which is judged only where {other} passed, "
                        "is {seen} and would tell of it; make {name} {hidden} as well",
                        hidden=hidden,
                        name=repr(check.name),
                        other=repr(other),
                        seen=seen,
                    ),
                )


def late(given: object, max_score: float) -> LatePolicy | None:
    """What late hand-ins cost; None where the file does not say when they are due.

    Raises:
        Mistake: something of it cannot be used.
    """
    if given is None:
        return None
    if not isinstance(given, dict) or "due" not in given:
        example = f"due: {_EXAMPLE}, per_day: 10"
        raise Mistake(
            ("late",), say("expected at least when it is due, e.g. {{{example}}}", example=example)
        )
    for key, value in given.items():
        if key not in LATE:
            raise Mistake(
                ("late",),
                say("unknown {key}; {hint}", key=repr(key), hint=did_you_mean(key, LATE)),
            )
        if key != "due" and not is_amount(value):
            what = say("minutes") if key == "grace_min" else say("points")
            text = say(
                "expected a number of {what} from 0, e.g. 10; found {value}",
                what=what,
                value=repr(value),
            )
            raise Mistake(("late", key), text)
    amounts: dict[str, Any] = {"grace_min": 0, "per_day": 0, "most": max_score, **given}
    amounts = {key: float(value) for key, value in amounts.items() if key != "due"}
    return LatePolicy(_due(given["due"]), **amounts)


def _due(given: object) -> datetime:
    found = given
    if isinstance(given, str):
        try:
            found = datetime.fromisoformat(given)
        except ValueError:
            found = None
    if not isinstance(found, datetime) or found.utcoffset() is None:
        shown = given if isinstance(given, str) else str(given)
        raise Mistake(
            ("late", "due"),
            say(
                "expected a date, a time and its zone, e.g. {example}; found {shown}",
                example=_EXAMPLE,
                shown=shown,
            ),
        )
    return found
