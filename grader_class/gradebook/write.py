"""Write all files of the gradebook into the folder of a class.

    gradebook.csv  gradebook.jsonl
    export/moodle-grading-worksheet.csv  export/moodle-grade-import.csv  export/moodle-feedback.zip
    export/canvas-gradebook.csv  export/canvas-feedback.zip
    export/feedback.zip     if there is none for Moodle or Canvas
    export/notes.txt        what an import lacks

Which of them there are depends on what is known of the people. The same entries give the same
bytes, in each language.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from grader.exercise import View
from grader.system import files
from grader.text import Message, clip, listed, msg, plain, translate
from grader_class.entry import Entry
from grader_class.find.joining import NOT_CLEAR, UNCLEAR
from grader_class.gradebook import canvas, moodle
from grader_class.gradebook.feedback import Feedback, has_feedback
from grader_class.gradebook.grade import (
    LONGEST,
    Grade,
    canvas_file,
    decimal,
    grades,
    is_of_worksheet,
    participant,
)
from grader_class.reports.csv import cell, table
from grader_class.zipping import zipped

CSV, JSON_LINES, EXPORT = "gradebook.csv", "gradebook.jsonl", "export"
MOODLE_WORKSHEET, MOODLE_GRADES = "moodle-grading-worksheet.csv", "moodle-grade-import.csv"
CANVAS_GRADES, NOTES = "canvas-gradebook.csv", "notes.txt"
MOODLE_FEEDBACK, CANVAS_FEEDBACK = "moodle-feedback.zip", "canvas-feedback.zip"
FEEDBACK = "feedback.zip"
PSEUDONYMS = "pseudonyms.csv"
#: Without it Excel reads UTF-8 as Windows-1252.
BYTE_ORDER_MARK = "\ufeff"
_BEFORE = (
    *("id", "name", "hand_in", "group", "attempt", "handed_in", "state"),
    *("score", "late_days", "late_deduction", "final", "max_score"),
)
_AFTER = ("message",)


def write(
    out: Path,
    entries: Sequence[Entry],
    title: Message,
    view: View = "student",
    assignment: str = "",
) -> list[Message]:
    """Write all files, and remove exports that are not possible any more.

    Args:
        title: of the exercise.
        view: who reads the feedback: a student before, or after the exercise is due.
        assignment: Canvas's title or number of it, or both as in "Spiral (4711)"; '' for the
            exercise's title.

    Returns:
        Sentences on what an import lacks and who is left out.
    """
    everybody = grades(entries)
    name = translate(title)
    feedback = Feedback(view)
    heading = canvas.assignment_of(everybody, assignment or name)
    lacking = notes(everybody, heading)
    files.clear(out / EXPORT)  # it may be a link to another folder
    files.put(out / CSV, as_csv(everybody).encode("utf-8"))
    files.put(out / JSON_LINES, as_lines(everybody).encode("utf-8"))
    texts = {
        MOODLE_WORKSHEET: moodle.worksheet(everybody, feedback),
        MOODLE_GRADES: moodle.grade_import(everybody, name, feedback),
        CANVAS_GRADES: canvas.gradebook(everybody, heading),
        NOTES: "".join(f"{translate(note)}\n" for note in lacking),
    }
    exports = {name: text.encode("utf-8") for name, text in texts.items()}
    for file, content in (exports | _feedback(everybody, feedback)).items():
        if content:
            files.put(out / EXPORT / file, content)
        else:
            files.clear(out / EXPORT / file)
    return lacking


def write_pseudonyms(out: Path, entries: Sequence[Entry], of: Callable[[str], str]) -> None:
    """Write who has which pseudonym, and in which hand-in, which may be a group's.

    Args:
        entries: of a class under pseudonyms, with names; see `grader_class.pseudonyms`.
        of: returns the pseudonym of a student's id.
    """
    rows = [
        [cell(text) for text in (of(person.id), person.id, person.name, entry.folder.name)]
        for entry in entries
        for person in entry.hand_in.people
    ]
    text = table([("pseudonym", "id", "name", "hand_in"), *rows])
    files.put(out / PSEUDONYMS, (BYTE_ORDER_MARK + text).encode("utf-8"))


def _feedback(everybody: Sequence[Grade], feedback: Feedback) -> dict[str, bytes]:
    """Return the zips of feedback; empty bytes for one that would be empty."""

    def made(members: Mapping[str, Grade]) -> bytes:
        each = ((name, feedback.file(name, members[name].entry)) for name in sorted(members))
        return zipped(each) if members else b""

    for_moodle, for_canvas = moodle.feedback_files(everybody), canvas.feedback_files(everybody)
    others = {f"{g.entry.id}.html": g for g in everybody if has_feedback(g.entry)}
    return {
        MOODLE_FEEDBACK: made(for_moodle),
        CANVAS_FEEDBACK: made(for_canvas),
        FEEDBACK: b"" if for_moodle or for_canvas else made(others),
    }


def as_csv(grades: Sequence[Grade]) -> str:
    """Return a table with a header and one row a person.

    Each check has a column; its cell is empty where there is no verdict.
    """
    # in the order of the rubric
    checks = list(dict.fromkeys(check for grade in grades for check in grade.entry.verdicts))
    reserved = {*_BEFORE, *_AFTER}
    titles = [f"{check} (check)" if check in reserved else check for check in checks]
    header = [cell(title) for title in (*_BEFORE, *titles, *_AFTER)]
    return BYTE_ORDER_MARK + table([header, *(_row(grade, checks) for grade in grades)])


def _row(grade: Grade, checks: Sequence[str]) -> list[str]:
    entry, hand_in = grade.entry, grade.entry.hand_in
    earned = {check: verdict.score for check, verdict in entry.verdicts.items()}
    return [
        *map(cell, (grade.person.id, grade.person.name, hand_in.id, "; ".join(grade.group))),
        *(str(hand_in.attempt), "" if hand_in.at is None else hand_in.at.isoformat(), entry.state),
        *(decimal(grade.score), str(grade.late_days)),
        *map(decimal, (grade.late_deduction, grade.final, entry.max_score)),
        *(decimal(earned.get(check)) for check in checks),
        cell(clip(translate(entry.message), LONGEST)),
    ]


def as_lines(grades: Sequence[Grade]) -> str:
    """Return the gradebook as lines of JSON; texts are not escaped as for a spreadsheet."""
    return "".join(f"{json.dumps(_line(g), ensure_ascii=False, allow_nan=False)}\n" for g in grades)


def _line(grade: Grade) -> Any:
    entry, hand_in = grade.entry, grade.entry.hand_in
    line = {
        "id": grade.person.id,
        "name": grade.person.name,
        "hand_in": hand_in.id,
        "group": list(grade.group),
        "attempt": hand_in.attempt,
        "handed_in": None if hand_in.at is None else hand_in.at.isoformat(),
        "state": entry.state,
        "score": grade.score,
        "late_days": grade.late_days,
        "late_deduction": grade.late_deduction,
        "final": grade.final,
        "max_score": entry.max_score,
        "checks": {check: verdict.score for check, verdict in entry.verdicts.items()},
        "message": str(entry.message),
    }
    return plain(line)


# What an import lacks, and who is left out of it ------------------------------------------------

_NEITHER = msg(
    "Nothing tells what Moodle or Canvas call these people, so there is no import for them. For "
    "Moodle give --roster with its grading worksheet, for Canvas with its exported gradebook."
)


def notes(grades: Sequence[Grade], assignment: str) -> list[Message]:
    """Return notes on all imports, in the order of the files.

    Args:
        assignment: the heading of Canvas's column.
    """
    found = list(_of_grades(grades))
    is_moodle = any(participant(grade.person) for grade in grades)
    is_canvas = any(map(canvas.is_known, grades))
    if is_moodle:
        found += _of_moodle(grades)
    if is_canvas:
        found += _of_canvas(grades, assignment)
    if grades and not (is_moodle or is_canvas or moodle.grade_import_key(grades)):
        found.append(_NEITHER)
    return found


def _of_grades(grades: Sequence[Grade]) -> Iterator[Message]:
    failed = [grade for grade in grades if grade.entry.state == "failed"]
    if failed:
        yield msg(
            "{people} without a grade: the grader failed. They are in no import, so that what a "
            "course system has of them stays. Grade them again: --again failed",
            people=_people(failed),
        )
    if doubles := [grade for grade in grades if grade.is_double]:
        yield msg(
            "{people} with more than one hand-in: in the imports is the newest, or none where "
            "nothing tells which that is. Look at them yourself.",
            people=_people(doubles),
        )
    if unclear := [grade for grade in grades if grade.entry.hand_in.problem == UNCLEAR]:
        yield NOT_CLEAR.given(people=_people(unclear))


def _of_moodle(grades: Sequence[Grade]) -> Iterator[Message]:
    there = {id(grade) for grade in moodle.numbered(grades)}
    if lacking := [grade for grade in grades if id(grade) not in there]:
        yield msg(
            "Not in Moodle's grading worksheet and feedback: {people}, of whom the participant "
            "number is not known. Give --roster with Moodle's grading worksheet.",
            people=_people(lacking),
        )
    if not any(is_of_worksheet(grade.person) for grade in grades):
        yield msg(
            "The participant numbers are those in the names of Moodle's export. If groups have "
            "handed in, they are numbers of groups, which Moodle would take for those of students: "
            "then give --roster with Moodle's grading worksheet, or do not import them."
        )
    most = max(grade.entry.max_score for grade in grades)
    maxima = (grade.person.column("Maximum Grade") for grade in grades)
    others = dict.fromkeys(s for s in maxima if s and _number(s) not in (None, most))
    if others:
        yield msg(
            "Moodle's assignment has a maximum of {theirs}, the exercise of {ours:.10g}: Moodle "
            "leaves out what is above its own. Give it the exercise's.",
            theirs=clip(next(iter(others)), 20),
            ours=round(most, 2),
        )


def _of_canvas(grades: Sequence[Grade], assignment: str) -> Iterator[Message]:
    if lacking := [grade for grade in grades if not canvas.is_known(grade)]:
        yield msg(
            "Not in Canvas's gradebook: {people}, of whom Canvas's ID is not known. Give --roster "
            "with the gradebook that Canvas exports.",
            people=_people(lacking),
        )
    if not canvas.has_number(assignment):
        yield msg(
            "Canvas will ask which assignment {assignment!r} is: the heading of its column has no "
            "number. Give --roster with the gradebook that Canvas exports, or write there what "
            "stands in it: Spiral (4711)",
            assignment=assignment,
        )
    has_file = (g for g in grades if has_feedback(g.entry))
    if without := [g for g in has_file if not canvas_file(g.entry.hand_in)]:
        yield msg(
            "Not in Canvas's feedback: {people}, whose files do not have the names that Canvas "
            "gives to downloaded ones.",
            people=_people(without),
        )


def _people(grades: Sequence[Grade]) -> Message:
    return listed((grade.person.name or grade.person.id for grade in grades), 3)


def _number(value: str) -> float | None:
    try:
        return float(value.replace(",", "."))
    except ValueError:
        return None
