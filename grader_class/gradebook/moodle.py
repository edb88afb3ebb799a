"""Make the imports for Moodle: a grading worksheet, a table of grades, a zip of feedback.

The rules are those of Moodle's own code: mod/assign/feedback/offline, grade/import/csv and
mod/assign/feedback/file/importziplib.php.
"""

from __future__ import annotations

import html
import re
from collections.abc import Sequence

from grader.text import one_line, plain
from grader_class.gradebook.feedback import PAGE, Feedback, has_feedback, is_ours
from grader_class.gradebook.grade import (
    MOODLE_KEYS,
    Grade,
    decimal,
    identifier,
    is_of_worksheet,
    participant,
    safe_column,
)
from grader_class.reports.csv import cell, table

#: The columns of Moodle 3 and 4 in English. Moodle searches for Identifier, Grade, Last modified
#: (grade) and Feedback comments, by exactly these names.
WORKSHEET = (
    *("Identifier", "Full name", "Email address", "Status", "Grade", "Maximum Grade"),
    *("Grade can be changed", "Last modified (submission)", "Last modified (grade)"),
    "Feedback comments",
)
#: Moodle recognises a folder or file of feedback by this, after name and number.
_PLUGIN = "assignsubmission_file"
#: The longest name of a person in a file name [characters]; Moodle does not read it.
_LONGEST_NAME = 60
_NOT_IN_FILE_NAMES = re.compile(r'[\x00-\x1f\x7f_/\\<>:"|?*\ufffd]+')


def worksheet(grades: Sequence[Grade], feedback: Feedback) -> str:
    """Return the offline grading worksheet, in Moodle's format; '' where it would be empty.

    Moodle finds people by the participant number in `Identifier`. People without a grade are left
    out, and a comment that somebody else has written stays.
    """
    rows = [_worksheet_row(g, feedback) for g in numbered(grades) if g.final is not None]
    return table([WORKSHEET, *rows]) if rows else ""


def grade_import(grades: Sequence[Grade], title: str, feedback: Feedback) -> str:
    """Return a table for the import into the course's gradebook; '' where it would be empty.

    One column identifies people. Those without a value in it are left out: Moodle would read the
    row as one of the previous student.
    """
    key = grade_import_key(grades)
    rows = [
        (id_, cell(g.person.name), decimal(g.final), _comment(g, feedback))
        for g in grades
        if g.final is not None and (id_ := safe_column(g.person, *key))
    ]
    header = (key[0], "Full name", cell(title), f"{cell(title)} (Feedback)") if key else ()
    return table([header, *rows]) if rows else ""


def grade_import_key(grades: Sequence[Grade]) -> tuple[str, ...]:
    """Return the names of the column that identifies the most people; empty if it is none."""

    def count(key: tuple[str, ...]) -> int:
        return sum(bool(safe_column(grade.person, *key)) for grade in grades)

    key = max(MOODLE_KEYS, key=count)
    return key if count(key) else ()


def feedback_files(grades: Sequence[Grade]) -> dict[str, Grade]:
    """Return the names in the zip of feedback: Moodle reads the number, and shows the end."""
    return {
        f"{_name(grade)}_{participant(grade.person)}_{_PLUGIN}_{PAGE}": grade
        for grade in numbered(grades)
        if has_feedback(grade.entry)
    }


def numbered(grades: Sequence[Grade]) -> list[Grade]:
    """Return the grades of those whose participant number is known.

    If there is a worksheet, only its numbers count: a number in the name of an exported file may be
    that of a group, and in the worksheet that of another student.
    """
    listed = [grade for grade in grades if is_of_worksheet(grade.person)]
    return [grade for grade in listed or grades if participant(grade.person)]


def _worksheet_row(grade: Grade, feedback: Feedback) -> list[str]:
    def known_cell(column: str, default: str = "") -> str:
        return cell(grade.person.column(column) or default)

    return [
        identifier(grade.person),
        cell(grade.person.name) or known_cell("Full name"),
        cell(grade.person.column(*MOODLE_KEYS[0])),
        known_cell("Status"),
        decimal(grade.final),
        known_cell("Maximum Grade", decimal(grade.entry.max_score)),
        known_cell("Grade can be changed", "Yes"),
        safe_column(grade.person, "Last modified (submission)") or "-",
        safe_column(grade.person, "Last modified (grade)") or "-",
        _comment(grade, feedback),
    ]


def _comment(grade: Grade, feedback: Feedback) -> str:
    """Return the comment as HTML, which Moodle expects; one of somebody else stays as it is."""
    there = grade.person.column("Feedback comments")
    if there and not is_ours(there):
        return cell(one_line(there))
    return cell(html.escape(feedback.sentence(grade), quote=False))


def _name(grade: Grade) -> str:
    """Return a name for a file name: without underscores, at which Moodle splits it."""
    name = _NOT_IN_FILE_NAMES.sub(" ", plain(grade.person.name or grade.person.id))
    name = one_line(name).lstrip(".~ ")[:_LONGEST_NAME].rstrip(". ")
    return name or "Participant"
