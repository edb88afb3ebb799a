"""Moodle's Virtual Programming Lab: comments in a block, and the grade in the last line."""

from __future__ import annotations

from grader import text
from grader.exercise.verdict import Verdict
from grader.language.telling import tell
from grader.reports.error_report import ErrorReport
from grader.reports.report import Report
from grader.reports.wording import score_text, title_of, word


def render(report: Report) -> str:
    """The lines that `vpl_execution` prints. The activity's maximum grade has to be max_score."""
    lines = ["<|--", "-" + tell("What to do"), _quote(report.first_line)]
    lines += map(_quote, report.advice)
    lines += [
        tell("Also: {said}", said=_quote(said))
        for said in (*report.handed_in, report.not_shown)
        if said
    ]
    for verdict in report.verdicts:
        lines += _verdict(report, verdict)
    lines += ["--|>", f"Grade :=>> {text.points(report.score)}"]
    return "\n".join(lines) + "\n"


def render_error(report: ErrorReport) -> str:
    """The same lines; without a grade if none was judged, and then VPL gives none."""
    lines = ["<|--", f"-{report.title}", report.before]
    lines += [f"> {_quote(line)}" for line in report.message.splitlines()]
    lines += [line for line in (report.after,) if line]
    lines.append("--|>")
    if report.is_judged:
        lines.append("Grade :=>> 0")
    return "\n".join(lines) + "\n"


def _verdict(report: Report, verdict: Verdict) -> list[str]:
    # A title that ended with a number in brackets would be taken for a deduction.
    lines = [
        "-"
        + tell(
            "{title}: {word}, {score} points",
            title=_quote(title_of(verdict)),
            word=word(verdict),
            score=score_text(verdict),
        ),
        tell("Asked for: {title}", title=_quote(verdict.title)),
        tell("Seen: {rationale}", rationale=_quote(verdict.rationale)),
    ]
    if waited_for := report.waited_for(verdict):
        lines.append(tell("Waits for: {checks}", checks=_quote(", ".join(waited_for))))
    lines += [
        tell("Where: {where}", where=_quote(str(point))) for point in report.points_of(verdict)
    ]
    if verdict.help:
        lines.append(tell("Look at: {help}", help=_quote(verdict.help)))
    return lines


def _quote(value: str) -> str:
    """A text in one line that holds none of VPL's marks; it always follows a word of ours."""
    value = text.one_line(value).replace(":=>>", ": =>>")
    return value.replace("<|--", "< |--").replace("--|>", "-- |>")
