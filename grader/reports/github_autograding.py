"""What GitHub Classroom's autograding reporter read from `<STEP ID>_RESULTS`: base64 of JSON."""

from __future__ import annotations

import base64
import json
from typing import Any

from grader.reports import text
from grader.reports.report import Report, ShownVerdict


def render(report: Report) -> str:
    """One line of base64."""
    passed = all(verdict.passed for verdict in report.verdicts)
    document = {
        "version": 1,
        "status": "pass" if passed else "fail",
        "max_score": text.number(report.max_score),
        "tests": [_test(verdict) for verdict in report.verdicts],
    }
    return base64.b64encode(json.dumps(document).encode()).decode() + "\n"


def _test(verdict: ShownVerdict) -> dict[str, Any]:
    return {
        "name": f"{verdict.name}: {verdict.title}",
        "status": "pass" if verdict.passed else "fail",
        "score": text.number(verdict.score),
        "message": "\n".join(verdict.lines()),
        "test_code": verdict.name,
        "filename": "",
        "line_no": 0,
        "duration": 0,
    }
