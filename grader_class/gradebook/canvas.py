"""Make the imports for Canvas: its gradebook as CSV, and a zip for "Upload Submissions".

The rules are those of Canvas's own code: lib/gradebook_importer.rb, and in
app/models/abstract_assignment.rb `infer_comment_context_from_filename`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from grader_class.gradebook.feedback import has_feedback
from grader_class.gradebook.grade import (
    SIS_LOGIN_ID,
    SIS_USER_ID,
    Grade,
    canvas_file,
    canvas_id,
    decimal,
    safe_column,
)
from grader_class.reports.csv import cell, table

_HEADER = ("Student", "ID", SIS_USER_ID, SIS_LOGIN_ID, "Section")
_POINTS_POSSIBLE = "Points Possible"
_ASSIGNMENT = re.compile(r"(.*)\s\((\d+)\)", re.DOTALL)


def gradebook(grades: Sequence[Grade], assignment: str) -> str:
    """Return the table; '' where it would be empty.

    Canvas finds people by ID, then by the SIS ids. People without any of them, or without a grade,
    are left out: two may have one name, and an empty cell deletes the grade that is there.

    Args:
        assignment: the heading of the column; see `assignment_of`.
    """
    rows = [row for grade in grades if grade.final is not None and (row := _row(grade))]
    if not rows:
        return ""
    most = max(grade.entry.max_score for grade in grades)
    possible = (f"    {_POINTS_POSSIBLE}", "", "", "", "", decimal(most))
    return table([(*_HEADER, cell(assignment)), possible, *rows])


def is_known(grade: Grade) -> bool:
    """Whether Canvas can find a person by an id."""
    return any(_ids(grade))


def assignment_of(grades: Sequence[Grade], wanted: str) -> str:
    """Return Canvas's name of an assignment, with its number, if the roster is its gradebook.

    Args:
        wanted: its title, its number, both as in "Spiral (4711)", or the title of the exercise.

    Returns:
        the heading of the column; `wanted` itself where no column fits.
    """
    titles = dict.fromkeys(name for grade in grades for name in grade.person.columns)
    columns = {name: match for name in titles if (match := _ASSIGNMENT.fullmatch(name))}
    for name, match in columns.items():
        if wanted in (name, match[1], match[2]):
            return name
    return next(iter(columns)) if len(columns) == 1 else wanted


def has_number(assignment: str) -> bool:
    """Whether a heading contains the number by which Canvas finds the assignment."""
    return _ASSIGNMENT.fullmatch(assignment) is not None


def feedback_files(grades: Sequence[Grade]) -> dict[str, Grade]:
    """Return the names in the zip: those of the downloaded files, one for a whole group.

    Canvas shows the feedback under the name of the submission, so it has that one's format.
    """
    named = ((canvas_file(grade.entry.hand_in), grade) for grade in grades)
    return {name: grade for name, grade in named if name and has_feedback(grade.entry)}


def _row(grade: Grade) -> list[str]:
    ids = _ids(grade)
    if not any(ids):
        return []
    name = cell(grade.person.column("Student") or grade.person.name)
    if _POINTS_POSSIBLE in name:  # Canvas would treat the row as that of the possible points
        name = cell(grade.person.id)
    section = cell(grade.person.column("Section"))
    return [name, *ids, section, decimal(grade.final)]


def _ids(grade: Grade) -> tuple[str, str, str]:
    person = grade.person
    user, login = (safe_column(person, name) for name in (SIS_USER_ID, SIS_LOGIN_ID))
    return canvas_id(person), user, login
