"""The `<STEP ID>_RESULTS` of GitHub Classroom's autograding reporter: JSON in base64."""

from __future__ import annotations

import base64
import json
from typing import Any, Final

from grader.reports import ErrorReport, Format, Report
from grader.text import msg, number, translate
from grader_class.reports.lines import led_lines


def render(report: Report) -> str:
    passed = all(verdict.passed for verdict in report.verdicts) and not report.not_shown
    tests = [
        _test(
            verdict.check,
            f"{verdict.check}: {translate(verdict.title)}",
            "pass" if verdict.passed else "fail",
            verdict.score,
            led_lines(report, verdict),
        )
        for verdict in report.verdicts
    ]
    if report.not_shown:  # as failed, whatever their verdicts: else all would seem to pass
        name = report.not_shown_name
        tests.append(_test(name, name, "fail", 0, [report.not_shown]))
    return _document("pass" if passed else "fail", report.max_score, tests)


def render_error(report: ErrorReport) -> str:
    """Return one line of base64, with the status `error` where nothing was judged."""
    status = "fail" if report.is_judged else "error"
    test = _test("submission", report.title, status, 0, report.paragraphs)
    return _document(status, report.max_score or 0, [test])


def _document(status: str, max_score: float, tests: list[dict[str, Any]]) -> str:
    document = {
        "version": 1,
        "status": status,
        "max_score": number(max_score),
        "tests": tests,
    }
    return base64.b64encode(json.dumps(document).encode()).decode() + "\n"


def _test(code: str, name: str, status: str, score: float, lines: list[str]) -> dict[str, Any]:
    return {
        "name": name,
        "status": status,
        "score": number(score),
        "message": "\n".join(lines),
        "test_code": code,
        "filename": "",
        "line_no": 0,
        "duration": 0,
    }


FORMAT: Final = Format(msg("GitHub Classroom's old reporter"), render, render_error)
