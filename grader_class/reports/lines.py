"""A verdict as lines, and a run in words: for formats that show plain text, and no page."""

from __future__ import annotations

from grader import Verdict
from grader.reports import Report
from grader.scenes import load_subject
from grader.scenes.view import Solid
from grader.text import one_line, tr, translate


def verdict_lines(report: Report, verdict: Verdict) -> list[str]:
    """Return the rationale, the evidence and the hint."""
    found = [one_line(translate(verdict.rationale))]
    if waited_for := report.waited_for(verdict):
        found.append(tr("Waits for: {checks}", checks=", ".join(waited_for)))
    found += [f"- {one_line(str(point))}" for point in report.points_of(verdict)]
    if verdict.help:
        found.append(tr("Look at: {help}", help=one_line(translate(verdict.help))))
    return [line for line in found if line]


def led_lines(report: Report, verdict: Verdict) -> list[str]:
    """Return the lines with the diagnosis first, for formats that have no other place for it.

    It leads the first check that did not pass, unless the diagnosis repeats that check.
    """
    own, found = verdict_lines(report, verdict), report.diagnosis
    first = next((each for each in report.verdicts if not each.passed), None)
    if found is None or verdict is not first or found.check == verdict.check:
        return own
    return [report.first_line, *report.advice, "", *own]


def solid_words(report: Report) -> str:
    """Return in words what only a page can draw, of the nominal run; '' where there is nothing."""
    recording = report.recordings.get(0)
    parts = load_subject(recording.scene).view(recording.trace).parts if recording else ()
    return next((translate(part.text) for part in parts if isinstance(part, Solid)), "")
