"""Moodle's Virtual Programming Lab: comments in a block, and the grade in the last line."""

from __future__ import annotations

from grader.reports import text
from grader.reports.report import Report, ShownVerdict


def render(report: Report) -> str:
    """The lines that `vpl_execution` prints. The activity's maximum grade has to be max_score."""
    lines = ["<|--", "-What to do", f"Now: {_quote(report.headline)}"]
    for verdict in report.verdicts:
        lines += _verdict(verdict)
    lines += ["--|>", f"Grade :=>> {text.points(report.score)}"]
    return "\n".join(lines) + "\n"


def _verdict(verdict: ShownVerdict) -> list[str]:
    # A title that ended with a number in brackets would be taken for a deduction.
    lines = [
        f"-{_quote(verdict.name)}: {verdict.word}, {verdict.score_text} points",
        f"Asked for: {_quote(verdict.title)}",
        f"Seen: {_quote(verdict.rationale)}",
    ]
    if verdict.waited_for:
        lines.append(f"Waits for: {_quote(', '.join(verdict.waited_for))}")
    lines += [f"Where: {_quote(str(point))}" for point in verdict.points]
    if verdict.help:
        lines.append(f"Look at: {_quote(verdict.help)}")
    return lines


def _quote(value: str) -> str:
    """A text in one line that holds none of VPL's marks; it always follows a word of ours."""
    value = text.one_line(value).replace(":=>>", ": =>>")
    return value.replace("<|--", "< |--").replace("--|>", "-- |>")
