"""What Moodle imports: an assignment's grading worksheet, a table of grades, a zip of feedback.

The rules are those of Moodle's own code: mod/assign/feedback/offline, grade/import/csv and
mod/assign/feedback/file/importziplib.php.
"""

from __future__ import annotations

import html
import re
from collections.abc import Sequence

from grader import text
from grader.batch.gradebook import known
from grader.batch.gradebook.feedback import Feedback, has_feedback, is_ours
from grader.batch.gradebook.grade import Grade, decimal
from grader.reports.csv import cell, table

#: Those that Moodle 3 and 4 write in English. It looks for Identifier, Grade, Last modified (grade)
#: and Feedback comments, by these very names.
WORKSHEET = (
    *("Identifier", "Full name", "Email address", "Status", "Grade", "Maximum Grade"),
    *("Grade can be changed", "Last modified (submission)", "Last modified (grade)"),
    "Feedback comments",
)
#: What a folder or file of the feedback has after name and number, so that Moodle knows it.
_PLUGIN = "assignsubmission_file"
FEEDBACK = "feedback.html"
#: Of a name, so much is in a file name [characters]; it is for people alone.
_LONGEST_NAME = 60
_NOT_IN_FILE_NAMES = re.compile(r'[\x00-\x1f\x7f_/\\<>:"|?*\ufffd]+')


def worksheet(grades: Sequence[Grade], feedback: Feedback) -> str:
    """The offline grading worksheet, as Moodle gives and takes it; '' where it would be empty.

    Moodle finds people by the participant number in `Identifier`. Who has no grade is left out, and
    a comment that somebody else has written stays.
    """
    rows = [_worksheet_row(g, feedback) for g in numbered(grades) if g.final is not None]
    return table([WORKSHEET, *rows]) if rows else ""


def grade_import(grades: Sequence[Grade], title: str, feedback: Feedback) -> str:
    """A table for the import of the course's gradebook; '' where it would be empty.

    It has one column to find people by. Who has nothing in it is left out: Moodle would take the
    row for one of the student before.
    """
    key = grade_import_key(grades)
    rows = [
        (id_, cell(g.person.name), decimal(g.final), _comment(g, feedback))
        for g in grades
        if g.final is not None and (id_ := known.safe_column(g.person, key))
    ]
    header = (key[0], "Full name", cell(title), f"{cell(title)} (Feedback)") if key else ()
    return table([header, *rows]) if rows else ""


def grade_import_key(grades: Sequence[Grade]) -> tuple[str, ...]:
    """The names of the column by which most can be found; none if nobody can."""

    def so_many(key: tuple[str, ...]) -> int:
        return sum(bool(known.safe_column(grade.person, key)) for grade in grades)

    key = max(known.MOODLE_KEYS, key=so_many)
    return key if so_many(key) else ()


def feedback_files(grades: Sequence[Grade]) -> dict[str, Grade]:
    """The names in the zip of feedback: Moodle takes the number, and shows what is behind it."""
    return {
        f"{_name(grade)}_{known.participant(grade.person)}_{_PLUGIN}_{FEEDBACK}": grade
        for grade in numbered(grades)
        if has_feedback(grade.entry)
    }


def numbered(grades: Sequence[Grade]) -> list[Grade]:
    """Those whose participant number is known.

    Where there is a worksheet, its numbers alone count: one that stands in the name of an export
    only may be that of a group, and in the worksheet that of some other student.
    """
    listed = [grade for grade in grades if known.is_of_worksheet(grade.person)]
    return [grade for grade in listed or grades if known.participant(grade.person)]


def _worksheet_row(grade: Grade, feedback: Feedback) -> list[str]:
    def said(column: str, otherwise: str = "") -> str:
        return cell(known.column(grade.person, (column,)) or otherwise)

    return [
        known.identifier(grade.person),
        cell(grade.person.name) or said("Full name"),
        cell(known.column(grade.person, known.MOODLE_KEYS[0])),
        said("Status"),
        decimal(grade.final),
        said("Maximum Grade", decimal(grade.entry.max_score)),
        said("Grade can be changed", "Yes"),
        known.safe_column(grade.person, ("Last modified (submission)",)) or "-",
        known.safe_column(grade.person, ("Last modified (grade)",)) or "-",
        _comment(grade, feedback),
    ]


def _comment(grade: Grade, feedback: Feedback) -> str:
    """Moodle takes a comment for HTML; one that is not ours stays as it is."""
    there = known.column(grade.person, ("Feedback comments",))
    if there and not is_ours(there):
        return cell(text.one_line(there))
    return cell(html.escape(feedback.sentence(grade), quote=False))


def _name(grade: Grade) -> str:
    """A name as it may stand in a file name: without low lines, for Moodle counts by them."""
    name = _NOT_IN_FILE_NAMES.sub(" ", text.plain(grade.person.name or grade.person.id))
    name = text.one_line(name).lstrip(".~ ")[:_LONGEST_NAME].rstrip(". ")
    return name or "Participant"
