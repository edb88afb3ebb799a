"""PrairieLearn's `/grade/results/results.json`: a score from 0 to 1, at most 1 MB in all."""

from __future__ import annotations

import json
from typing import Any, Final

from grader import Verdict
from grader.reports import ErrorReport, Format, Report, canvas_uri
from grader.reports.wording import title_of, word
from grader.text import clip, msg, number, tr, translate
from grader_class.reports.lines import solid_words, verdict_lines

#: PrairieLearn refuses a file above 1 MB.
LIMIT_BYTES = 1_000_000
_OUTPUT_LIMIT = 20_000


def render(report: Report) -> str:
    """Return the JSON document, without picture or even explanations if it would be too large."""
    picture = canvas_uri(report)
    images = [{"label": tr("The window at the end"), "url": picture}] if picture else []
    for shown, tests_in_full in ((images, True), ([], True), ([], False)):
        document = json.dumps(_document(report, shown, tests_in_full)) + "\n"
        if len(document) <= LIMIT_BYTES:  # json.dumps writes ASCII: characters are bytes
            break
    return document


def render_error(report: ErrorReport) -> str:
    """Return the JSON document: not gradable, which costs the student no attempt."""
    document = {"gradable": False, "score": 0, "format_errors": "\n\n".join(report.paragraphs)}
    return json.dumps(document) + "\n"


def _document(report: Report, images: list[dict[str, str]], in_full: bool) -> dict[str, Any]:
    nothing = {"name": report.not_shown_name, "points": 0, "max_points": 0}
    left_out = [{**nothing, "message": report.not_shown}] if report.not_shown else []
    lines = [report.first_line, *report.advice, *report.notes]
    if not images and (words := solid_words(report)):
        lines.append(words)
    return {
        "gradable": True,
        "score": _share(report),
        "message": clip("\n".join(lines), 1000),
        "output": clip(report.output, _OUTPUT_LIMIT, keeps_end=True),
        "images": images,
        "tests": [_test(report, verdict, in_full) for verdict in report.verdicts] + left_out,
    }


def _test(report: Report, verdict: Verdict, in_full: bool) -> dict[str, Any]:
    test = {
        "name": tr("{title} ({word})", title=title_of(verdict), word=word(verdict)),
        "points": number(verdict.score),
        "max_points": number(verdict.max_score),
    }
    if in_full:
        test["description"] = translate(verdict.title)
        test["message"] = "\n".join(verdict_lines(report, verdict))
    return test


def _share(report: Report) -> float:
    if report.max_score <= 0:
        all_passed = all(verdict.passed for verdict in report.verdicts)
        return 1.0 if all_passed and not report.not_shown else 0.0
    return min(report.score / report.max_score, 1.0)


FORMAT: Final = Format(msg("PrairieLearn's results.json"), render, render_error)
