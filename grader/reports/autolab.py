"""Autolab: the last two lines of an autograder's output. One problem a check, under its name."""

from __future__ import annotations

import json

from grader.reports import text
from grader.reports.report import Report

_STAGE = "Checks"


def render(report: Report) -> str:
    """Two lines of JSON: how to show the checks, and the scores. Nothing may be printed after."""
    feedback = {
        "_presentation": "semantic",
        "stages": [_STAGE],
        _STAGE: {
            verdict.name: {"passed": True}
            if verdict.passed
            else {"passed": False, "hint": _hint(verdict.word, verdict.lines())}
            for verdict in report.verdicts
        },
    }
    scores = {"scores": {v.name: text.number(v.score) for v in report.verdicts}}
    return f"{json.dumps(feedback)}\n{json.dumps(scores)}\n"


def _hint(word: str, lines: list[str]) -> str:
    return " ".join([f"{word.capitalize()}.", *lines])
