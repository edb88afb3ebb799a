"""Moodle's Virtual Programming Lab: comments in a block, and the grade in the last line."""

from __future__ import annotations

from typing import Final

from grader import Verdict
from grader.reports import ErrorReport, Format, Report
from grader.reports.wording import score_text, title_of, word
from grader.text import msg, number, one_line, tr, translate


def render(report: Report) -> str:
    """Return what `vpl_execution` prints. The activity's maximum grade has to be max_score."""
    lines = ["<|--", "-" + tr("What to do"), _quote(report.first_line)]
    lines += map(_quote, report.advice)
    lines += [tr("Also: {said}", said=_quote(note)) for note in report.notes]
    for verdict in report.verdicts:
        lines += _verdict(report, verdict)
    lines += ["--|>", f"Grade :=>> {number(report.score)}"]
    return "\n".join(lines) + "\n"


def render_error(report: ErrorReport) -> str:
    """Return these lines for an error; without a grade if nothing was judged."""
    lines = ["<|--", f"-{report.title}", report.before]
    lines += [f"> {_quote(line)}" for line in report.message.splitlines()]
    lines += [line for line in (report.after,) if line]
    lines.append("--|>")
    if report.is_judged:
        lines.append("Grade :=>> 0")
    return "\n".join(lines) + "\n"


def _verdict(report: Report, verdict: Verdict) -> list[str]:
    # VPL reads a title that ends with a number in brackets as a deduction.
    lines = [
        "-"
        + tr(
            "{title}: {word}, {score} points",
            title=_quote(title_of(verdict)),
            word=word(verdict),
            score=score_text(verdict),
        ),
        tr("Asked for: {title}", title=_quote(translate(verdict.title))),
        tr("Seen: {rationale}", rationale=_quote(translate(verdict.rationale))),
    ]
    if waited_for := report.waited_for(verdict):
        lines.append(tr("Waits for: {checks}", checks=_quote(", ".join(waited_for))))
    lines += [tr("Where: {where}", where=_quote(str(point))) for point in report.points_of(verdict)]
    if verdict.help:
        lines.append(tr("Look at: {help}", help=_quote(translate(verdict.help))))
    return lines


def _quote(value: str) -> str:
    """Return a text in one line without VPL's marks; never put it at the start of a line."""
    value = one_line(value).replace(":=>>", ": =>>")
    return value.replace("<|--", "< |--").replace("--|>", "-- |>")


FORMAT: Final = Format(msg("Moodle's Virtual Programming Lab"), render, render_error)
