"""Makes the data of a page that plays runs: of recordings, and a report where there is one."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from typing import Any

from grader.recording.observations import Burst, End
from grader.recording.recording import Recording, Recordings
from grader.reports import wording
from grader.reports.report import Point, Report
from grader.scenes.playback import JudgedCheck, Playback, PlayedRun
from grader.scenes.scene import STEP_NS
from grader.text import strings as text
from grader.text.translations import tr, translate


def of(
    name: str, recordings: Recordings, report: Report | None, other: Playback | None = None
) -> Playback:
    """Make a playback of recordings.

    Args:
        name: the title of the page, where there is no report.
        report: on these recordings; None where nothing was judged.
        other: to compare with.
    """
    runs = tuple(_played_run(number, each) for number, each in enumerate(recordings))
    if report is None:
        return Playback(text.shown(name), "", runs, (), other)
    where = tr("Where: {where}", where=report.where_first) if report.where_first else ""
    return Playback(
        title=tr("{title}: {score}", title=report.submission, score=report.score_text),
        summary=f"{report.first_line} {where}".strip(),
        runs=runs,
        judged=judged(report, len(runs)),
        other=other,
    )


def judged(report: Report, runs: int) -> tuple[JudgedCheck, ...]:
    """Return the verdicts as shown, with evidence from the first so many runs."""
    return tuple(
        JudgedCheck(
            wording.title_of(each),
            each.status,
            tr("{word}, {score} points", word=wording.word(each), score=wording.score_text(each)),
            translate(each.rationale),
            translate(each.help),
            tuple(_moment(point) for point in report.points_of(each) if point.evidence.run < runs),
        )
        for each in report.verdicts
    )


def _played_run(number: int, recording: Recording) -> PlayedRun:
    outcome = wording.outcome_text(recording.run.outcome.replace("_", " "))
    start = recording.start
    if start is not None:
        outcome = tr("{outcome}; {begins}", outcome=outcome, begins=start.words)
    after = recording.run.simulated_s
    outcome = tr("{outcome}, after {simulated_s:.1f} s", outcome=outcome, simulated_s=after)
    return PlayedRun(
        wording.run_name(number),
        wording.with_drawn(outcome, recording.run.drawn),
        recording.trace,
        start,
        _sent(recording),
    )


def _sent(recording: Recording) -> tuple[End, ...]:
    """Return the ends that sent, with their lines, as the submission's process has reported.

    A name with several of them is left out: the order in which these sent is not known.
    """
    by_name: dict[str, list[End]] = defaultdict(list)
    for end in recording.observations.ends:
        if not end.lines and end.used_at is not None:
            end = replace(end, lines=(end.used_at,), sent=(Burst(0, 1),))
        if end.lines:
            by_name[end.name].append(end)
    return tuple(ends[0] for ends in by_name.values() if len(ends) == 1)


def _moment(point: Point) -> dict[str, Any]:
    seen = point.evidence
    x, y = seen.place or (None, None)
    tick = round(seen.time_s * 1e9 / STEP_NS)
    return {
        "number": point.number,
        "run": seen.run,
        "tick": tick,
        "x": x,
        "y": y,
        "text": str(point),
    }
