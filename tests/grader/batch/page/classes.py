"""Classes to be shown, without a run."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from pathlib import Path
from typing import Any

from grader.batch.entry import Entry, State
from grader.batch.hand_in import HandIn, Person
from grader.batch.page.students import Student, students
from grader.result.result import Result
from tests.grader.reports import samples
from tests.grader.reports.samples import verdict


def result(points: Mapping[str, float], rationale: str = "It is 1 m off.", **more: Any) -> Result:
    """Ten points a check; what has less failed, what is negative was not judged."""
    listed = [
        verdict(check, "passed")
        if earned == 10
        else verdict(check, "not_judged", 0)
        if earned < 0
        else verdict(check, "failed", earned, rationale=rationale)
        for check, earned in points.items()
    ]
    return Result.from_json(samples.result(*listed, **more))


def entry(
    id: str,
    judged: Result | None = None,
    *,
    name: str = "",
    state: State = "judged",
    message: str = "",
    at: datetime | None = None,
    folder: Path = Path("/nowhere"),
) -> Entry:
    """A hand-in; judged where there is a result."""
    hand_in = HandIn(id, (Person(id, name),), at=at)
    return Entry(hand_in, state, 20.0, message=message, result=judged, folder=folder)


def student(judged: Result | None = None, **more: Any) -> Student:
    """The only one of a class."""
    (only,) = students([entry("zoe", judged, **more)])
    return only
