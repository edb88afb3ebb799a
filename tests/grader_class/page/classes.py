"""Classes to be shown, without a run."""

from dataclasses import replace
from pathlib import Path

from grader.exercise.result.result import Result
from grader.text.message import Message, msg
from grader_class.entry import Entry, HandIn, Person
from grader_class.page import html
from grader_class.page.html import students
from tests.grader.reports import samples
from tests.grader.reports.samples import verdict

OFF = msg("It is {metres} m off.", metres=1)


def result(points, rationale=OFF, **more):
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
    said = Message.of(rationale)
    verdicts = (replace(v, rationale=said) if v.status == "failed" else v for v in made.verdicts)
    return replace(made, verdicts=tuple(verdicts))


def entry(
    id, judged=None, *, name="", state="judged", message="", at=None, folder=Path("/nowhere")
):
    """A hand-in; judged where there is a result."""
    hand_in = HandIn(id, (Person(id, name),), at=at)
    return Entry(hand_in, state, 20.0, message=Message.of(message), result=judged, folder=folder)


def student(judged=None, **more):
    (only,) = students([entry("zoe", judged, **more)])
    return only


def first_page(*of_class):
    return html.render_all(*of_class)[html.PAGE]
