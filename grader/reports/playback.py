"""What a page that plays runs is made from: recordings, and a report on them where there is one."""

from __future__ import annotations

from grader import text
from grader.recording.recording import Recording, Recordings
from grader.reports import wording
from grader.reports.report import Report
from grader.scenes.playback import Judged, Line, Moment, Playback, Take


def of(
    name: str, recordings: Recordings, report: Report | None, other: Playback | None = None
) -> Playback:
    """Put it together.

    Args:
        name: whose recordings these are, where no report tells it.
        report: what was judged, for who may see it; None where nobody has judged.
        other: what it is to be compared with.
    """
    takes = tuple(_take(number, each) for number, each in enumerate(recordings))
    if report is None:
        return Playback(text.one_line(text.plain(name)), "", takes, (), other)
    where = f"Where: {report.where_first}" if report.where_first else ""
    return Playback(
        title=f"{report.submission}: {report.score_text}",
        summary=f"{report.first_line} {where}".strip(),
        takes=takes,
        judged=tuple(_judged(report, index, len(takes)) for index in range(len(report.verdicts))),
        other=other,
    )


def _take(number: int, recording: Recording) -> Take:
    outcome = recording.run.outcome.replace("_", " ")
    start = recording.start
    if start is not None:
        outcome = f"{outcome}; from {text.place(start.x, start.y)}"
    return Take(
        number,
        f"Varied run {number}" if number else "Nominal run",
        f"{outcome}, after {recording.run.simulated_s:.1f} s",
        recording.trace,
        start,
        _lines(recording),
    )


def _lines(recording: Recording) -> tuple[Line, ...]:
    """Of each name the line that it was first sent from, as the submission's process has told."""
    found: dict[str, Line] = {}
    for end in recording.conduct.ends:
        place = end.used_at
        if place is not None and end.kind != "subscription":
            found.setdefault(end.name, Line(end.name, place.file, place.line, place.text))
    return tuple(found.values())


def _judged(report: Report, index: int, runs: int) -> Judged:
    verdict = report.verdicts[index]
    points = report.points_of(verdict)
    return Judged(
        wording.title_of(verdict),
        verdict.status,
        f"{wording.word(verdict)}, {wording.score_text(verdict)} points",
        verdict.rationale,
        verdict.help,
        tuple(
            Moment(
                point.number,
                point.evidence.run,
                point.evidence.tick,
                point.evidence.x if point.evidence.has_place else None,
                point.evidence.y if point.evidence.has_place else None,
                f"{point.where}: {point.evidence.note}",
            )
            for point in points
            if point.evidence.run < runs
        ),
    )
