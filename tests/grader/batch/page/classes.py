"""Classes to be shown, without a run."""

from collections.abc import Mapping
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any

from grader.batch.entry import Entry, HandIn, Person, State
from grader.batch.page import html
from grader.batch.page.html import Student, students
from grader.message import Message, as_message, msg
from grader.result.result import Result
from tests.grader.reports import samples
from tests.grader.reports.samples import verdict

OFF = msg("It is {metres} m off.", metres=1)


def result(points: Mapping[str, float], rationale: str | Message = OFF, **more: Any) -> Result:
    """Ten points a check; what has less failed, what is negative was not judged."""
    listed = [
        verdict(check, "passed")
        if earned == 10
        else verdict(check, "not_judged", 0)
        if earned < 0
        else verdict(check, "failed", earned)
        for check, earned in points.items()
    ]
    made = Result.from_json(samples.result(*listed, **more))
    said = as_message(rationale)
    verdicts = (replace(v, rationale=said) if v.status == "failed" else v for v in made.verdicts)
    return replace(made, verdicts=tuple(verdicts))


def entry(
    id: str,
    judged: Result | None = None,
    *,
    name: str = "",
    state: State = "judged",
    message: str | Message = "",
    at: datetime | None = None,
    folder: Path = Path("/nowhere"),
) -> Entry:
    """A hand-in; judged where there is a result."""
    hand_in = HandIn(id, (Person(id, name),), at=at)
    return Entry(hand_in, state, 20.0, message=as_message(message), result=judged, folder=folder)


def student(judged: Result | None = None, **more: Any) -> Student:
    """The only one of a class."""
    (only,) = students([entry("zoe", judged, **more)])
    return only


def first_page(*of_class: Any) -> str:
    """The first page of a class, which is the only one of most."""
    return html.render_all(*of_class)[html.PAGE]
