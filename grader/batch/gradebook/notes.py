"""What an import lacks, and who is left out of it, as sentences for the teacher."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from grader import text
from grader.batch.find.joining import UNCLEAR
from grader.batch.gradebook import canvas, known, moodle
from grader.batch.gradebook.grade import Grade
from grader.language.phrase import Phrase, joined, say

_NEITHER = say(
    "Nothing tells what Moodle or Canvas call these people, so there is no import for them. For "
    "Moodle give --roster with its grading worksheet, for Canvas with its exported gradebook."
)


def notes(grades: Sequence[Grade], assignment: str) -> list[str]:
    """All that is to be said, in the order of the files.

    Args:
        assignment: the heading of Canvas's column.
    """
    found = list(_of_grades(grades))
    is_moodle = any(known.participant(grade.person) for grade in grades)
    is_canvas = any(map(canvas.is_known, grades))
    if is_moodle:
        found += _of_moodle(grades)
    if is_canvas:
        found += _of_canvas(grades, assignment)
    if grades and not (is_moodle or is_canvas or moodle.grade_import_key(grades)):
        found.append(_NEITHER)
    return found


def _of_grades(grades: Sequence[Grade]) -> Iterator[str]:
    failed = [grade for grade in grades if grade.entry.state == "failed"]
    if failed:
        yield say(
            "{people} without a grade: the grader failed. They are in no import, so that what a "
            "course system has of them stays. Grade them again: --again failed",
            people=_people(failed),
        )
    if doubles := [grade for grade in grades if grade.is_double]:
        yield say(
            "{people} with more than one hand-in: in the imports is the newest, or none where "
            "nothing tells which that is. Look at them yourself.",
            people=_people(doubles),
        )
    if unclear := [grade for grade in grades if grade.entry.hand_in.problem == UNCLEAR]:
        yield say(
            "{people} without a grade, and in no import: a hand-in that is nobody's may be theirs. "
            "Make clear in the roster, or in the names of the files, who is who.",
            people=_people(unclear),
        )


def _of_moodle(grades: Sequence[Grade]) -> Iterator[str]:
    there = {id(grade) for grade in moodle.numbered(grades)}
    if lacking := [grade for grade in grades if id(grade) not in there]:
        yield say(
            "Not in Moodle's grading worksheet and feedback: {people}, of whom the participant "
            "number is not known. Give --roster with Moodle's grading worksheet.",
            people=_people(lacking),
        )
    if not any(known.is_of_worksheet(grade.person) for grade in grades):
        yield say(
            "The participant numbers are those in the names of Moodle's export. If groups have "
            "handed in, they are numbers of groups, which Moodle would take for those of students: "
            "then give --roster with Moodle's grading worksheet, or do not import them."
        )
    most = max(grade.entry.max_score for grade in grades)
    said = (known.column(grade.person, ("Maximum Grade",)) for grade in grades)
    others = dict.fromkeys(s for s in said if s and _number(s) not in (None, most))
    if others:
        yield say(
            "Moodle's assignment has a maximum of {theirs}, the exercise of {ours:.10g}: Moodle "
            "leaves out what is above its own. Give it the exercise's.",
            theirs=text.clip(next(iter(others)), 20),
            ours=round(most, 2),
        )


def _of_canvas(grades: Sequence[Grade], assignment: str) -> Iterator[str]:
    if lacking := [grade for grade in grades if not canvas.is_known(grade)]:
        yield say(
            "Not in Canvas's gradebook: {people}, of whom Canvas's ID is not known. Give --roster "
            "with the gradebook that Canvas exports.",
            people=_people(lacking),
        )
    if not canvas.has_number(assignment):
        yield say(
            "Canvas will ask which assignment {assignment!r} is: the heading of its column has no "
            "number. Give --roster with the gradebook that Canvas exports, or write there what "
            "stands in it: Spiral (4711)",
            assignment=assignment,
        )
    has_file = (g for g in grades if g.entry.state in ("judged", "unusable"))
    if without := [g for g in has_file if not known.canvas_file(g.entry.hand_in)]:
        yield say(
            "Not in Canvas's feedback: {people}, whose files do not have the names that Canvas "
            "gives to downloaded ones.",
            people=_people(without),
        )


def _people(grades: Sequence[Grade]) -> str:
    """How many, and the first of them."""
    first = (text.clip(text.one_line(g.person.name or g.person.id), 40) for g in grades[:3])
    names, more = joined([Phrase(name) for name in first], ", "), len(grades) - 3
    return say("{names} and {more:,} more", names=names, more=more) if more > 0 else names


def _number(value: str) -> float | None:
    try:
        return float(value.replace(",", "."))
    except ValueError:
        return None
