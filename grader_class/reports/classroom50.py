"""Classroom 50's `result.json`: whole points, and the identity from the runner's environment."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from datetime import datetime
from decimal import ROUND_HALF_UP, Decimal
from typing import Any, Final

from grader import UsageError, Verdict
from grader.reports import ErrorReport, Format, Report
from grader.text import msg, number, one_line
from grader_class.reports.lines import led_lines

_SCHEMA = "classroom50/result/v1"
_NEEDED = ("CLASSROOM", "ASSIGNMENT", "SUBMISSION_TAG", "COMMIT_URL", "RELEASE_URL")
_TYPES = ("individual", "group")


def render(report: Report) -> str:
    """Return the JSON document."""
    scores, max_scores = whole_points(report.verdicts)
    tests: list[dict[str, Any]] = [
        {
            "test-name": verdict.check,
            "passed": verdict.passed,
            "score": score,
            "max-score": max_score,
            "status": verdict.status,
            "exact-score": number(verdict.score),
            "message": "\n".join(led_lines(report, verdict)),
        }
        for verdict, score, max_score in zip(report.verdicts, scores, max_scores, strict=True)
    ]
    if report.not_shown:
        left_out = {"test-name": report.not_shown_name, "passed": False, "score": 0, "max-score": 0}
        tests.append({**left_out, "status": "not_shown", "message": report.not_shown})
    return _document(report.made, sum(scores), sum(max_scores), tests)


def render_error(report: ErrorReport) -> str:
    """Return a document with 0 points and one test, which has the reason."""
    if not report.is_judged:
        raise UsageError(
            "the format classroom50 cannot say that nothing was judged; leave with an exit "
            "code other than 0 instead: {message}",
            message=one_line(report.message),
        )
    max_score = int(_half_up(_decimal(report.max_score or 0)))
    test = {
        "test-name": "submission",
        "passed": False,
        "score": 0,
        "max-score": max_score,
        "message": "\n\n".join(report.paragraphs),
    }
    return _document(report.made, 0, max_score, [test])


def _document(made: datetime, score: int, max_score: int, tests: list[dict[str, Any]]) -> str:
    now = made.strftime("%Y-%m-%dT%H:%M:%SZ")
    document = {
        "schema": _SCHEMA,
        **_identity(os.environ),
        # The runner puts the time of the commit here; this is for calls without a runner.
        "datetime": now,
        "graded_at": now,
        "score": score,
        "max-score": max_score,
        "tests": tests,
    }
    return json.dumps(document, indent=2) + "\n"


def _identity(env: Mapping[str, str]) -> dict[str, str]:
    owner = env.get("OWNER") or env.get("USERNAME") or ""
    missing = [name for name in _NEEDED if not env.get(name)]
    if not owner:
        missing.append("OWNER (or USERNAME)")
    if missing:
        raise UsageError(
            "the format classroom50 needs the environment of a Classroom 50 autograder; "
            "not set: {missing}",
            missing=", ".join(missing),
        )
    if not env["SUBMISSION_TAG"].startswith("submit/"):
        raise UsageError(
            "SUBMISSION_TAG is {tag!r}, expected a tag that starts with submit/",
            tag=env["SUBMISSION_TAG"],
        )
    kind = env.get("ASSIGNMENT_TYPE") or _TYPES[0]
    if kind not in _TYPES:
        types = msg("{one} or {other}", one=_TYPES[0], other=_TYPES[1])
        raise UsageError("ASSIGNMENT_TYPE is {kind!r}, expected {types}", kind=kind, types=types)
    return {
        "classroom": env["CLASSROOM"],
        "assignment": env["ASSIGNMENT"],
        "assignment_type": kind,
        "owner": owner,
        "submission": env["SUBMISSION_TAG"],
        "commit": env["COMMIT_URL"],
        "release": env["RELEASE_URL"],
        "review": env.get("REVIEW_URL") or env["COMMIT_URL"],
    }


def whole_points(verdicts: Sequence[Verdict]) -> tuple[list[int], list[int]]:
    """Return the points of each verdict, and the most points, rounded by largest remainders.

    The total is rounded half up. Every score is rounded down, and the points that are then missing
    from the total go to the scores that lost most. Where a check is worth 2.5 points, all points
    count ten times (or a hundred times), so that passing is worth the same to the last digit.
    """
    most = [_decimal(v.max_score) for v in verdicts]
    factor = next((f for f in (1, 10) if all(m * f % 1 == 0 for m in most)), 100)
    max_scores = [int(_half_up(m * factor)) for m in most]
    exact = [
        min(_decimal(v.score) * factor, Decimal(m))
        for v, m in zip(verdicts, max_scores, strict=True)
    ]
    scores = [int(score) for score in exact]
    missing = int(_half_up(sum(exact, Decimal(0)))) - sum(scores)
    by_loss = sorted(range(len(exact)), key=lambda i: scores[i] - exact[i])
    for index in by_loss[:missing]:
        scores[index] += 1
    return scores, max_scores


def _decimal(value: float) -> Decimal:
    return Decimal(str(round(value, 2)))


def _half_up(value: Decimal) -> Decimal:
    return value.to_integral_value(ROUND_HALF_UP)


FORMAT: Final = Format(msg("Classroom 50's result.json"), render, render_error)
