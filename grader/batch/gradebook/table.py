"""gradebook.csv: one row a person, for people and their spreadsheets."""

from __future__ import annotations

from collections.abc import Sequence

from grader import text
from grader.batch.gradebook.cells import cell, table
from grader.batch.gradebook.grade import LONGEST, Grade, decimal

#: Without it Excel takes UTF-8 for the letters of Windows.
BYTE_ORDER_MARK = "\ufeff"
_BEFORE = (
    *("id", "name", "hand_in", "group", "attempt", "handed_in", "state"),
    *("score", "late_deduction", "final", "max_score"),
)
_AFTER = ("message",)


def render(grades: Sequence[Grade]) -> str:
    """A header and one row a person.

    Each check has a column of its own; what was not judged, or has no result, is empty there.
    """
    checks = check_names(grades)
    taken = {*_BEFORE, *_AFTER}
    titles = [f"{check} (check)" if check in taken else check for check in checks]
    header = [cell(title) for title in (*_BEFORE, *titles, *_AFTER)]
    return BYTE_ORDER_MARK + table([header, *(_row(grade, checks) for grade in grades)])


def check_names(grades: Sequence[Grade]) -> list[str]:
    """The names of all checks, in the order of the rubric."""
    results = [grade.entry.result for grade in grades if grade.entry.result is not None]
    return list(dict.fromkeys(v.check for result in results for v in result.verdicts))


def _row(grade: Grade, checks: Sequence[str]) -> list[str]:
    entry, hand_in = grade.entry, grade.entry.hand_in
    earned = {} if entry.result is None else {v.check: v.score for v in entry.result.verdicts}
    return [
        *map(cell, (grade.person.id, grade.person.name, hand_in.id, "; ".join(grade.group))),
        *(str(hand_in.attempt), "" if hand_in.at is None else hand_in.at.isoformat(), entry.state),
        *map(decimal, (grade.score, grade.late_deduction, grade.final, entry.max_score)),
        *(decimal(earned.get(check)) for check in checks),
        cell(text.clip(entry.message, LONGEST)),
    ]
