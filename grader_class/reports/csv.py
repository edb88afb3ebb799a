"""CSV: one row per submission, so that a teacher gets the results of a class as one table."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Sequence
from typing import Any, Final

from grader.reports import ErrorReport, Format, Report, wording
from grader.text import clip, msg, number, one_line, plain

_BEFORE = ("submission", "exercise", "score", "max_score")
#: Also the full-width characters of Chinese, Japanese and Korean.
_BEGIN_FORMULAS = (*"=+-@", *"\uff1d\uff0b\uff0d\uff20")
#: With a decimal comma, spreadsheets separate cells at a semicolon.
_CUT_BEFORE_FORMULA = re.compile(r"(; ?)(?=[=+@\-\uff1d\uff0b\uff0d\uff20])")
#: Begins like a formula, but without brackets, quotes, `!` and `|` it can call and fetch nothing:
#: +41791234567, @anna, -7.
_HARMLESS = re.compile(r"[+@-]?[\w.@+-]*")
_HAS_CONTROLS = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff]")
_AFTER = ("outcome", "first_to_mend", "flags", "trace_sha256", "folder")


def render(report: Report | ErrorReport) -> str:
    return render_all([report])


def render_all(reports: Sequence[Report | ErrorReport]) -> str:
    """Return a header, and one row per result or error.

    Each check has two columns: its points under its name, and its verdict under `NAME verdict`. An
    exercise's checks that another does not have stay empty, as do points that were not judged.
    The table is for teachers, so nothing is hidden in it.
    """
    reports = [each.whole if isinstance(each, Report) else each for each in reports]
    results = [report for report in reports if isinstance(report, Report)]
    checks = list(dict.fromkeys(v.check for report in results for v in report.verdicts))
    header = [*_BEFORE]
    for name in checks:
        column = f"{name} (check)" if name in (*_BEFORE, *_AFTER) else name
        header += [column, f"{column} verdict"]
    rows = (
        _row(each, checks) if isinstance(each, Report) else _error_row(each, checks)
        for each in reports
    )
    return table([[cell(title) for title in (*header, *_AFTER)], *rows])


def _row(report: Report, checks: list[str]) -> list[Any]:
    verdicts = {verdict.check: verdict for verdict in report.verdicts}
    row: list[Any] = [
        cell(report.submission),
        cell(report.exercise),
        number(report.score),
        number(report.max_score),
    ]
    for name in checks:
        verdict = verdicts.get(name)
        row += [number(verdict.score), str(wording.WORDS[verdict.status])] if verdict else ["", ""]
    found, lost = report.diagnosis, report.first_to_mend
    first = (found.check or found.key) if found else lost.check if lost else ""
    return [
        *row,
        report.run.outcome,
        cell(clip(f"{first}: {report.headline}", 300) if first else ""),
        cell("; ".join(report.flags)),
        cell(report.run.trace_sha256),
        cell(str(report.folder)),
    ]


def _error_row(report: ErrorReport, checks: list[str]) -> list[Any]:
    score = 0 if report.is_judged else ""
    max_score = "" if report.max_score is None else number(report.max_score)
    message = cell(clip(report.message, 300))
    return [
        *(cell(report.name), "", score, max_score),
        *[""] * (2 * len(checks)),
        *(report.state, message, "", "", cell(str(report.file or report.folder))),
    ]


def table(rows: Iterable[Sequence[object]]) -> str:
    r"""Return the text of a file: commas, quotes where they are needed, `\n` after each row."""
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows(rows)
    return out.getvalue()


def cell(value: str) -> str:
    """Return a text in one line that no spreadsheet reads as a formula, wherever it is cut."""
    value = one_line(plain(value))
    value = _CUT_BEFORE_FORMULA.sub(r"\1'", value)
    return f"'{value}" if value.startswith(_BEGIN_FORMULAS) else value


def is_safe_id(value: str) -> bool:
    """Whether an id may stand in a cell as it is.

    A system finds people by their ids, so an id cannot be quoted as a name can.
    """
    if _HAS_CONTROLS.search(value):
        return False
    return not value.startswith(_BEGIN_FORMULAS) or _HARMLESS.fullmatch(value) is not None


FORMAT: Final = Format(
    msg("one row a result, for a teacher's spreadsheet"), render, render, render_all
)
