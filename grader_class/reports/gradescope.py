"""Gradescope's `/autograder/results/results.json`. It knows passed and failed only.

Gradescope itself hides tests from students, and hides the total where it hides any. So the file
has the hidden tests as well, for teachers.
"""

from __future__ import annotations

import html
import json
from typing import Any, Final

from grader import Verdict
from grader.exercise import is_hidden
from grader.reports import ErrorReport, Format, Report, canvas_uri
from grader.text import clip, msg, number, tr, translate
from grader_class.reports.lines import solid_words, verdict_lines

_OUTPUT_LIMIT = 20_000
_HIDDEN = {"after_due": "after_due_date", "never": "hidden"}


def render(report: Report) -> str:
    """Return the JSON document, with the picture and the node's output above the tests."""
    document = {
        "score": number(report.whole.score),
        "execution_time": number(report.run.wall_s),
        "output": _overview(report),
        "output_format": "html",
        "test_output_format": "text",
        "test_name_format": "text",
        "tests": _tests(report),
    }
    return json.dumps(document, indent=2) + "\n"


def render_error(report: ErrorReport) -> str:
    """Return the JSON document; without a score if nothing was judged.

    For Gradescope the autograder has failed then.
    """
    document: dict[str, Any] = {
        "output": "\n\n".join(report.paragraphs),
        "output_format": "text",
        "tests": [],
    }
    if report.is_judged:
        document = {"score": 0, **document}
    else:
        document["extra_data"] = {"grader_failed": True}
    return json.dumps(document, indent=2) + "\n"


def _tests(report: Report) -> list[dict[str, Any]]:
    """Return all tests, each from the report for those who see it."""
    is_open = report.view == "whole" or all(v.visible == "now" for v in report.whole.verdicts)
    shown = iter(report.verdicts)
    tests = []
    for index, verdict in enumerate(report.whole.verdicts):
        if report.view != "whole" and is_hidden(verdict.visible, report.view == "after_due"):
            test = _test(report.whole, index, verdict) | {"visibility": _HIDDEN[verdict.visible]}
        else:
            test = _test(report, index, next(shown))
            test |= {} if is_open else {"visibility": "visible"}
        tests.append(test)
    return tests


def _test(report: Report, index: int, verdict: Verdict) -> dict[str, Any]:
    lines = verdict_lines(report, verdict)
    if verdict.status == "not_judged":
        lines.insert(0, tr("Not judged."))
    elif verdict.is_partial:
        lines.insert(0, tr("Partial credit."))
    return {
        "name": f"{verdict.check}: {translate(verdict.title)}",
        "number": str(index + 1),
        "score": number(verdict.score),
        "max_score": number(verdict.max_score),
        "status": "passed" if verdict.passed else "failed",
        "output": "\n".join(lines),
    }


def _overview(report: Report) -> str:
    parts = [f"<p><strong>{html.escape(report.first_line)}</strong></p>"]
    parts += [f"<p>{html.escape(line)}</p>" for line in (*report.advice, *report.notes)]
    picture = canvas_uri(report)
    if picture:
        alt = html.escape(tr("The window at the end"))
        parts.append(f'<p><img src="{picture}" width="500" alt="{alt}"></p>')
    elif words := solid_words(report):
        parts.append(f"<p>{html.escape(words)}</p>")
    output = clip(report.output.strip("\n"), _OUTPUT_LIMIT, keeps_end=True)
    if output:
        printed = html.escape(tr("What the node printed:"))
        parts.append(f"<p>{printed}</p><pre>{html.escape(output)}</pre>")
    return "".join(parts)


FORMAT: Final = Format(msg("Gradescope's results.json"), render, render_error)
