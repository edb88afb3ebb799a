"""GitHub-flavoured Markdown: a step summary, a release's text, a comment."""

from __future__ import annotations

import re
from typing import Final

from grader import Verdict
from grader.reports import ErrorReport, Format, Report, wording
from grader.reports.wording import score_text, title_of, word
from grader.text import clip, msg, one_line, tr, translate

_SIGNS = {"passed": "✅", "failed": "❌", "not_judged": "⏸️"}
#: Characters with a meaning in Markdown, anywhere or at the start of a line; a backslash escapes.
_SPECIAL = re.compile(r"([\\`*_\[\]<>#|~&$])")
_SPECIAL_AT_START = re.compile(r"^(\d*)([-+=.)])")
_OUTPUT_LIMIT = 10_000


def render(report: Report) -> str:
    """Return the report; it ends with a line break, to be appended to a file."""
    parts = [
        "## "
        + tr("{title}: {score} points", title=_quote(report.exercise), score=report.score_text),
        tr("Submission: {submission}", submission=_quote(report.submission)),
        _first(report),
        _table(report),
        *map(_quote, report.notes),
    ]
    parts += [_seen(report, verdict) for verdict in report.verdicts if verdict.status == "failed"]
    parts += [_run(report), _output(report)]
    return "\n\n".join(part for part in parts if part) + "\n"


def render_error(report: ErrorReport) -> str:
    title = report.title
    if report.is_judged:
        title = tr("{title}: {score} points", title=title, score=report.score_text)
    message = "\\\n".join(map(_quote, report.message.splitlines()))
    parts = [f"## {title}", report.before, message, report.after]
    return "\n\n".join(part for part in parts if part) + "\n"


def _quote(value: str) -> str:
    """Quote a text, in one line, that Markdown shows as it is."""
    quoted = _SPECIAL_AT_START.sub(r"\1\\\2", _SPECIAL.sub(r"\\\1", one_line(value)))
    # an entity and an invisible joiner: no address becomes a link, no name notifies anybody
    return quoted.replace("://", "&#58;//").replace("www.", "www&#46;").replace("@", "@\u2060")


def _first(report: Report) -> str:
    found, first = report.diagnosis, report.first_to_mend
    if found is None and first is None:
        return f"**{_quote(report.headline)}**"
    is_of_check = found is None or found.check
    if is_of_check and first is not None:
        about = tr("Fix this first, {title}:", title=_quote(title_of(first)))
    else:
        about = tr("Fix this first:")
    line = f"**{about}** {_quote(report.headline)}"
    return "\n\n".join([line, *map(_quote, report.advice)])


def _table(report: Report) -> str:
    headings = (tr("verdict"), tr("asked for"), tr("points"), tr("check"))
    rows = [f"| {' | '.join(headings)} |", "| --- | --- | ---: | --- |"]
    for verdict in report.verdicts:
        name = _quote(verdict.check)
        if waited_for := report.waited_for(verdict):
            name += " " + tr("(waits for {checks})", checks=_quote(", ".join(waited_for)))
        points = score_text(verdict)
        if verdict.is_partial:
            points += " " + tr("(partial credit)")
        sign = f"{_SIGNS[verdict.status]} {word(verdict)}"
        if seen := report.seen_by_students(verdict):
            name += " " + tr("({seen})", seen=seen)
        rows.append(f"| {sign} | {_quote(title_of(verdict))} | {points} | {name} |")
    if report.deducted:
        late = tr("handed in late")
        rows.append(f"| | {late} | -{wording.points(report.deducted)} | |")
    total = f"{wording.points(report.score)} / {wording.points(report.max_score)}"
    rows.append("| | **" + tr("total") + f"** | **{total}** | |")
    return "\n".join(rows)


def _seen(report: Report, verdict: Verdict) -> str:
    lines = [
        "### " + tr("{title}: {score}", title=_quote(title_of(verdict)), score=score_text(verdict)),
        "",
        _quote(translate(verdict.rationale)),
    ]
    if verdict.evidence:
        lines += ["", *(f"- {_quote(str(point))}" for point in report.points_of(verdict))]
    if help_ := report.help_for(verdict):
        lines += ["", "**" + tr("Look at:") + f"** {_quote(help_)}"]
    return "\n".join(lines)


def _run(report: Report) -> str:
    how = wording.how_it_ran(report.run, _quote(wording.outcome_text(report.outcome(0))))
    flags = ("- " + tr("Note: {flag}", flag=_quote(flag)) for flag in report.flags)
    return "\n".join([how, *flags])


def _output(report: Report) -> str:
    """Return the node's output in a fence that is longer than any in it."""
    output = clip(report.output.strip("\n"), _OUTPUT_LIMIT, keeps_end=True)
    if not output.strip():
        return ""
    longest = max((len(run) for run in re.findall(r"`+", output)), default=0)
    fence = "`" * max(3, longest + 1)
    return (
        "<details><summary>" + tr("What the node printed") + "</summary>\n\n"
        f"{fence}text\n{output}\n{fence}\n\n</details>"
    )


FORMAT: Final = Format(
    msg("a GitHub step summary, a comment, a release's text"), render, render_error
)
