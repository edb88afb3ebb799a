"""Autolab: the last two lines of an autograder's output. Each check is a problem by its name."""

from __future__ import annotations

import json
from typing import Any, Final

from grader import UsageError
from grader.reports import ErrorReport, Format, Report
from grader.reports.wording import word
from grader.text import msg, number, one_line, tr
from grader_class.reports.lines import led_lines

_STAGE = "Checks"


def render(report: Report) -> str:
    """Return two lines of JSON: feedback and scores. Nothing may be printed after them."""
    checks: dict[str, Any] = {
        verdict.check: {"passed": True}
        if verdict.passed
        else {"passed": False, "hint": _hint(word(verdict), led_lines(report, verdict))}
        for verdict in report.verdicts
    }
    if report.not_shown:
        checks[report.not_shown_name] = {"passed": False, "hint": report.not_shown}
    return _lines(checks, {each.check: number(each.score) for each in report.verdicts})


def render_error(report: ErrorReport) -> str:
    """Return the two lines with 0 points for each problem."""
    if not report.is_judged:
        raise UsageError(
            "the format autolab cannot say that nothing was judged; end without scores "
            "instead: {message}",
            message=one_line(report.message),
        )
    if not report.checks:
        raise UsageError(
            msg("the format autolab needs the exercise of an error: add --exercise NAME")
        )
    hint = {"passed": False, "hint": _hint(report.title, [one_line(report.message)])}
    return _lines(dict.fromkeys(report.checks, hint), dict.fromkeys(report.checks, 0))


def _lines(checks: dict[str, Any], scores: dict[str, Any]) -> str:
    feedback = {"_presentation": "semantic", "stages": [_STAGE], _STAGE: checks}
    return f"{json.dumps(feedback)}\n{json.dumps({'scores': scores})}\n"


def _hint(word: str, lines: list[str]) -> str:
    return " ".join([tr("{title}.", title=word.capitalize()), *filter(None, lines)])


FORMAT: Final = Format(
    msg("the last two lines of an Autolab autograder's output"), render, render_error
)
