"""Classroom 50's `result.json`: whole points, and what the runner says in the environment."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

from grader.errors import UsageError
from grader.reports import text
from grader.reports.report import Report
from grader.reports.whole_points import whole_points

_SCHEMA = "classroom50/result/v1"
_NEEDED = ("CLASSROOM", "ASSIGNMENT", "SUBMISSION_TAG", "COMMIT_URL", "RELEASE_URL")
_TYPES = ("individual", "group")


def render(report: Report) -> str:
    """The JSON document.

    Raises:
        UsageError: the environment is not the one that Classroom 50 gives to an autograder.
    """
    return json.dumps(_document(report, os.environ, datetime.now(UTC)), indent=2) + "\n"


def _document(report: Report, env: Mapping[str, str], now: datetime) -> dict[str, Any]:
    who = _identity(env)
    points = whole_points(report.verdicts)
    instant = now.strftime("%Y-%m-%dT%H:%M:%SZ")
    return {
        "schema": _SCHEMA,
        **who,
        # The runner puts the time of the commit here; this is for whoever calls without it.
        "datetime": instant,
        "graded_at": instant,
        "score": points.total,
        "max-score": points.max_total,
        "tests": [
            {
                "test-name": verdict.name,
                "passed": verdict.passed,
                "score": score,
                "max-score": max_score,
                "status": verdict.status,
                "exact-score": text.number(verdict.score),
                "message": "\n".join(verdict.lines()),
            }
            for verdict, score, max_score in zip(
                report.verdicts, points.scores, points.max_scores, strict=True
            )
        ],
    }


def _identity(env: Mapping[str, str]) -> dict[str, str]:
    owner = env.get("OWNER") or env.get("USERNAME") or ""
    missing = [name for name in _NEEDED if not env.get(name)]
    if not owner:
        missing.append("OWNER (or USERNAME)")
    if missing:
        raise UsageError(
            "the format classroom50 needs the environment of a Classroom 50 autograder; "
            f"not set: {', '.join(missing)}"
        )
    if not env["SUBMISSION_TAG"].startswith("submit/"):
        raise UsageError(
            f"SUBMISSION_TAG is {env['SUBMISSION_TAG']!r}, expected a tag that starts with submit/"
        )
    kind = env.get("ASSIGNMENT_TYPE") or _TYPES[0]
    if kind not in _TYPES:
        raise UsageError(f"ASSIGNMENT_TYPE is {kind!r}, expected {' or '.join(_TYPES)}")
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
