"""CSV: one row a submission, so that the results of a class make one table."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from typing import Any

from grader.reports import text
from grader.reports.report import Report

_BEFORE = ("submission", "exercise", "score", "max_score")
_AFTER = ("outcome", "first_to_mend", "flags", "trace_sha256", "folder")


def render(report: Report) -> str:
    """The table of one result."""
    return render_all([report])


def render_all(reports: Sequence[Report]) -> str:
    """A header and one row a result.

    Each check has two columns: its points under its name, and its verdict under `NAME verdict`. An
    exercise's checks that another does not have stay empty.
    """
    checks = list(dict.fromkeys(v.name for report in reports for v in report.verdicts))
    header = [*_BEFORE]
    for name in checks:
        column = f"{name} (check)" if name in (*_BEFORE, *_AFTER) else name
        header += [column, f"{column} verdict"]
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([_cell(title) for title in (*header, *_AFTER)])
    writer.writerows([_row(report, checks) for report in reports])
    return out.getvalue()


def _row(report: Report, checks: list[str]) -> list[Any]:
    verdicts = {verdict.name: verdict for verdict in report.verdicts}
    row: list[Any] = [
        _cell(report.submission),
        _cell(report.exercise),
        text.number(report.score),
        text.number(report.max_score),
    ]
    for name in checks:
        verdict = verdicts.get(name)
        row += [text.number(verdict.score), verdict.word] if verdict else ["", ""]
    first = report.first_to_mend
    return [
        *row,
        report.run["outcome"],
        _cell(text.clip(f"{first.name}: {report.headline}", 300) if first else ""),
        _cell("; ".join(report.run["flags"])),
        _cell(report.run["trace_sha256"]),
        _cell(str(report.folder)),
    ]


def _cell(value: str) -> str:
    """A text in one line that no spreadsheet takes for a formula."""
    value = text.one_line(value)
    return f"'{value}" if value.startswith(("=", "+", "-", "@")) else value
