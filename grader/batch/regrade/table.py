"""A regrade as CSV: a row for each check of each hand-in that changes, or is not judged again."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator
from typing import Any

from grader.batch.entry import Entry
from grader.batch.regrade.changes import Change, Difference, Regrade
from grader.exercise.verdict import Verdict
from grader.reports.csv import cell
from grader.reports.wording import WORDS
from grader.text import clip, number

HEADER = (
    *("id", "name", "before", "after", "change"),
    *("check", "check_before", "check_after", "check_change", "verdict_before", "verdict_after"),
    "why",
)
NOT_JUDGED_AGAIN = "not judged again"
_LONGEST = 1000


def render(found: Regrade) -> str:
    """The table; its columns are those of `HEADER`."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(HEADER)
    for change in found.changes:
        writer.writerows(_rows(change))
    for failure in found.failures:
        score = _points(failure.entry.score)
        why = cell(clip(f"{NOT_JUDGED_AGAIN}: {failure.why}", _LONGEST))
        writer.writerow([*_who(failure.entry), score, score, 0, *[""] * 6, why])
    return out.getvalue()


def _rows(change: Change) -> Iterator[list[Any]]:
    scores = _points(change.before.score), _points(change.after.score), number(change.points)
    for each in change.differences:
        yield [*_who(change.before), *scores, *_check(each), cell(clip(each.why, _LONGEST))]


def _who(entry: Entry) -> list[str]:
    return [cell(entry.id), cell(entry.hand_in.name)]


def _check(each: Difference) -> list[Any]:
    old, new = (_score(verdict) for verdict in (each.before, each.after))
    verdicts = [str(WORDS[v.status]) if v else "" for v in (each.before, each.after)]
    return [cell(each.check or each.title), old, new, number(each.points), *verdicts]


def _score(verdict: Verdict | None) -> float | int | str:
    return number(verdict.score) if verdict else ""


def _points(score: float | None) -> float | int | str:
    return "" if score is None else number(score)
