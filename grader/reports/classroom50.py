"""Classroom 50's `result.json`: whole points, and what the runner says in the environment."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

from grader import text
from grader.errors import UsageError
from grader.language.phrase import say
from grader.reports.error_report import ErrorReport
from grader.reports.report import Report
from grader.reports.whole_points import WholePoints, whole_points, zero_points

_SCHEMA = "classroom50/result/v1"
_NEEDED = ("CLASSROOM", "ASSIGNMENT", "SUBMISSION_TAG", "COMMIT_URL", "RELEASE_URL")
_TYPES = ("individual", "group")


def render(report: Report) -> str:
    """The JSON document.

    Raises:
        UsageError: the environment is not the one that Classroom 50 gives to an autograder.
    """
    points = whole_points(report.verdicts)
    tests: list[dict[str, Any]] = [
        {
            "test-name": verdict.check,
            "passed": verdict.passed,
            "score": score,
            "max-score": max_score,
            "status": verdict.status,
            "exact-score": text.number(verdict.score),
            "message": "\n".join(report.led_lines(verdict)),
        }
        for verdict, score, max_score in zip(
            report.verdicts, points.scores, points.max_scores, strict=True
        )
    ]
    if report.not_shown:
        left_out = {"test-name": report.not_shown_name, "passed": False, "score": 0, "max-score": 0}
        tests.append({**left_out, "status": "not_shown", "message": report.not_shown})
    return _document(points, tests)


def render_error(report: ErrorReport) -> str:
    """0 points, with one test that says why.

    Raises:
        UsageError: as above, or there is no judgement. Classroom 50 takes an exit code other than 0
            for that, and no result.json.
    """
    if not report.is_judged:
        raise UsageError(
            say(
                "the format classroom50 cannot say that nothing was judged; leave with an exit "
                "code other than 0 instead: {message}",
                message=text.one_line(report.message),
            )
        )
    points = zero_points(report.max_score or 0)
    test = {
        "test-name": "submission",
        "passed": False,
        "score": points.total,
        "max-score": points.max_total,
        "message": "\n\n".join(report.paragraphs),
    }
    return _document(points, [test])


def _document(points: WholePoints, tests: list[dict[str, Any]]) -> str:
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    document = {
        "schema": _SCHEMA,
        **_identity(os.environ),
        # The runner puts the time of the commit here; this is for whoever calls without it.
        "datetime": now,
        "graded_at": now,
        "score": points.total,
        "max-score": points.max_total,
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
            say(
                "the format classroom50 needs the environment of a Classroom 50 autograder; "
                "not set: {missing}",
                missing=", ".join(missing),
            )
        )
    if not env["SUBMISSION_TAG"].startswith("submit/"):
        raise UsageError(
            say(
                "SUBMISSION_TAG is {tag!r}, expected a tag that starts with submit/",
                tag=env["SUBMISSION_TAG"],
            )
        )
    kind = env.get("ASSIGNMENT_TYPE") or _TYPES[0]
    if kind not in _TYPES:
        types = say("{one} or {other}", one=_TYPES[0], other=_TYPES[1])
        raise UsageError(
            say("ASSIGNMENT_TYPE is {kind!r}, expected {types}", kind=kind, types=types)
        )
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
