"""What an import lacks, and who is left out of it, as sentences for the teacher."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from grader import text
from grader.batch.find.joining import UNCLEAR
from grader.batch.gradebook import canvas, known, moodle
from grader.batch.gradebook.grade import Grade

_NEITHER = (
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
        yield (
            f"{_people(failed)} without a grade: the grader failed. They are in no import, so that "
            "what a course system has of them stays. Grade them again: --again failed"
        )
    if doubles := [grade for grade in grades if grade.is_double]:
        yield (
            f"{_people(doubles)} with more than one hand-in: in the imports is the newest, or none "
            "where nothing tells which that is. Look at them yourself."
        )
    if unclear := [grade for grade in grades if grade.entry.hand_in.problem == UNCLEAR]:
        yield (
            f"{_people(unclear)} without a grade, and in no import: a hand-in that is nobody's may "
            "be theirs. Make clear in the roster, or in the names of the files, who is who."
        )


def _of_moodle(grades: Sequence[Grade]) -> Iterator[str]:
    there = {id(grade) for grade in moodle.numbered(grades)}
    if lacking := [grade for grade in grades if id(grade) not in there]:
        yield (
            f"Not in Moodle's grading worksheet and feedback: {_people(lacking)}, of whom the "
            "participant number is not known. Give --roster with Moodle's grading worksheet."
        )
    if not any(known.is_of_worksheet(grade.person) for grade in grades):
        yield (
            "The participant numbers are those in the names of Moodle's export. If groups have "
            "handed in, they are numbers of groups, which Moodle would take for those of students: "
            "then give --roster with Moodle's grading worksheet, or do not import them."
        )
    most = max(grade.entry.max_score for grade in grades)
    said = (known.column(grade.person, ("Maximum Grade",)) for grade in grades)
    others = dict.fromkeys(s for s in said if s and _number(s) not in (None, most))
    if others:
        yield (
            f"Moodle's assignment has a maximum of {text.clip(next(iter(others)), 20)}, the "
            f"exercise of {text.points(most)}: Moodle leaves out what is above its own. Give it "
            "the exercise's."
        )


def _of_canvas(grades: Sequence[Grade], assignment: str) -> Iterator[str]:
    if lacking := [grade for grade in grades if not canvas.is_known(grade)]:
        yield (
            f"Not in Canvas's gradebook: {_people(lacking)}, of whom Canvas's ID is not known. "
            "Give --roster with the gradebook that Canvas exports."
        )
    if not canvas.has_number(assignment):
        yield (
            f"Canvas will ask which assignment {assignment!r} is: the heading of its column has no "
            "number. Give --roster with the gradebook that Canvas exports, or write there what "
            "stands in it: Spiral (4711)"
        )
    has_file = (g for g in grades if g.entry.state in ("judged", "unusable"))
    if without := [g for g in has_file if not known.canvas_file(g.entry.hand_in)]:
        yield (
            f"Not in Canvas's feedback: {_people(without)}, whose files do not have the names that "
            "Canvas gives to downloaded ones."
        )


def _people(grades: Sequence[Grade]) -> str:
    """How many, and the first of them."""
    names = [text.clip(text.one_line(g.person.name or g.person.id), 40) for g in grades[:3]]
    more = f" and {len(grades) - 3:,} more" if len(grades) > 3 else ""
    return f"{', '.join(names)}{more}"


def _number(value: str) -> float | None:
    try:
        return float(value.replace(",", "."))
    except ValueError:
        return None
