"""One self-contained HTML page: no network, no files beside it, and useful without its script.

The template is `templates/page.html`; jinja2 escapes all values in it, and a content security
policy lets only the scripts of the page run.
"""

from __future__ import annotations

import base64
import hashlib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final
from weakref import WeakKeyDictionary

import jinja2
import numpy as np
from markupsafe import Markup

from grader.exercise.result.diagnosis import Diagnosis
from grader.exercise.result.result import RunSummary
from grader.exercise.verdict import Evidence
from grader.recording.recording import Recording
from grader.reports import readable, wording
from grader.reports.formats import ErrorReport, Format
from grader.reports.page import templating
from grader.reports.page.animation import Animation, animation, solid_data
from grader.reports.page.pictures import RADIUS_PX, Pin, canvas_uri, pins, recorded_uri
from grader.reports.page.plots import HEIGHT, WIDTH, Drawn, Plots, expected, plots
from grader.reports.report import Report
from grader.scenes.scene import Scene
from grader.scenes.subject import Subject, load_subject
from grader.scenes.view import Floats, Plane, Solid, Table, Tree
from grader.text import strings as text
from grader.text.message import msg
from grader.text.translations import current, number, tr, translate

_TEMPLATES = Path(__file__).parent / "templates"
_OUTPUT_LIMIT = 100_000
#: Printed on paper: at most this many last lines and characters of a node's output.
_PAPER_LINES, _PAPER_LIMIT = 25, 4000
#: A plane has marks at its metres where one is no shorter.
_LEAST_METRE_PX = 10.0


@dataclass(frozen=True)
class Drawing:
    """The parts of a page that depend on a recording alone.

    Attributes:
        animation, plots: None without a recording.
        solid, trees, tables: the parts of the view; one solid can be turned.
    """

    animation: Animation | None = None
    plots: Plots | None = None
    solid: Solid | None = None
    trees: tuple[Tree, ...] = ()
    tables: tuple[Table, ...] = ()


@dataclass(frozen=True, kw_only=True)
class RunView(Drawing):
    """A run as the page shows it.

    Attributes:
        number: 0 for the nominal one.
        title: its name, with the start of a varied run.
        facts: its summary in the result file.
        picture: the scene's plane at the end as data URI, or ''.
        expected: what checks expect of curves, by their titles.
        pins: the evidence in the plane.
        output: of the node.
        on_paper: whether it is printed: there is a fault in it, or in no run at all.
    """

    number: int
    title: str
    facts: RunSummary
    picture: str
    expected: Mapping[str, Drawn]
    pins: tuple[Pin, ...]
    output: str
    on_paper: bool

    @property
    def output_end(self) -> str:
        return "\n".join(self.output.splitlines()[-_PAPER_LINES:])[-_PAPER_LIMIT:]

    @property
    def has_plane(self) -> bool:
        return bool(self.picture or self.pins or (self.animation and self.animation.tracks))

    @property
    def can_be_seen(self) -> bool:
        """Whether there is a plane, or curves whose time can be chosen below it."""
        return self.has_plane or bool(self.plots and self.plots.curves and not self.solid)


def render(report: Report) -> str:
    plane = report.subject.plane
    numbers = range(len(report.varied_runs) + 1)
    on_paper = _faulty_runs(report).intersection(numbers) or {0}
    runs = [_view(report, number, number in on_paper) for number in numbers]
    first_fault = _first_fault(report)
    return (
        _environment()
        .get_template("page.html")
        .render(
            report=report,
            runs=runs,
            animations={r.number: _script_data(r.animation) for r in runs if r.animation},
            pinned={pin.point.number for run in runs if run.can_be_seen for pin in run.pins},
            has_parts=any(run.solid or run.trees or run.tables for run in runs),
            has_solids=any(run.solid for run in runs),
            has_no_scene=not isinstance(report.subject, Scene),
            opens_at=first_fault if first_fault and first_fault.run in numbers else None,
            titles={verdict.check: wording.title_of(verdict) for verdict in report.verdicts},
            places={verdict.check: index for index, verdict in enumerate(report.verdicts)},
            outcomes=_outcomes(report.subject),
            flags=readable.flags,
            box={
                **{"width": WIDTH, "height": HEIGHT},
                **{"size": plane.size_px, "meter": plane.metre_px, "origin": plane.origin_m},
                "metres": _metres(plane),
            },
            to_px=plane.to_px,
            thing=translate(report.subject.thing),
            the=translate(report.subject.the_thing),
            words=_script_words(),
            radius=RADIUS_PX,
        )
    )


def _metres(plane: Plane) -> range:
    """Return the metres that have a mark; none of a plane in which they could not be told apart."""
    if plane.metre_px < _LEAST_METRE_PX:
        return range(0)
    return range(math.floor(plane.origin_m) + 1, math.ceil(plane.end_m))


def _first_fault(report: Report) -> Diagnosis | Evidence | None:
    """Return the diagnosis or evidence that locates the first fault; None for neither."""
    found = report.diagnosis
    if found is not None and not found.check:
        return found
    first = report.first_to_mend
    return first.evidence[0] if first is not None and first.evidence else None


def _faulty_runs(report: Report) -> set[int]:
    """Return the runs with a fault; one without evidence belongs to the nominal run."""
    found = report.diagnosis
    diagnosed = {found.run} if found is not None and not found.check else set()
    return diagnosed | {
        run
        for verdict in report.verdicts
        if verdict.status == "failed"
        for run in ({item.run for item in verdict.evidence} or {0})
    }


def _outcomes(subject: Subject) -> dict[str, str]:
    the = subject.the_thing
    return {
        "exited": tr("the node ended by itself, without an error"),
        "crashed": tr("the node ended with an error"),
        "stalled": tr("the node stopped responding"),
        "time limit": tr("{the_thing} was still going at the time limit", the_thing=the),
        wording.NOTHING_MOVED: tr("{the_thing} never moved, so the run was ended", the_thing=the),
        "killed": tr("somebody killed the node"),
        **{key: translate(clause) for key, clause in subject.outcomes.items()},
    }


def _script_words() -> dict[str, str]:
    return {
        "play": tr("Play"),
        "pause": tr("Pause"),
        "end": tr("end"),
        "seconds": tr("{seconds} s", seconds="#"),
        "point": number("0.0")[1:-1],
    }


def render_error(report: ErrorReport) -> str:
    return _environment().get_template("error.html").render(report=report)


@cache
def _environment() -> jinja2.Environment:
    made = templating.environment(_TEMPLATES, "page")
    code = (_TEMPLATES / "solid.js").read_text(encoding="utf-8")
    made.globals.update(
        solid_script=Markup(code),
        solid_digest=base64.b64encode(hashlib.sha256(code.encode()).digest()).decode(),
        parts_style=Markup((_TEMPLATES / "parts.css").read_text(encoding="utf-8")),
        solid_data=solid_data,
        all_passed=wording.all_passed,
        see_first=wording.SEE_FIRST,
        place=text.place,
        word=wording.word,
        run_name=wording.run_name,
        so_many=wording.so_many,
        clock=wording.clock,
        outcome_word=wording.outcome_text,
        isolation=wording.isolation,
        points=wording.points,
        score_text=wording.score_text,
    )
    return made


#: Recording -> language -> drawing.
_drawings: WeakKeyDictionary[Recording, dict[str, Drawing]] = WeakKeyDictionary()


def draw(recording: Recording) -> Drawing:
    """Draw a recording once in a language: for its pages, and for that of a class."""
    drawings = _drawings.setdefault(recording, {})
    drawing = drawings.get(current())
    if drawing is None:
        view = load_subject(recording.scene).view(recording.trace)
        duration_ns = recording.trace.duration_ns
        drawing = Drawing(
            animation(view, duration_ns),
            plots(view, duration_ns),
            next((part for part in view.parts if isinstance(part, Solid)), None),
            tuple(part for part in view.parts if isinstance(part, Tree)),
            tuple(part for part in view.parts if isinstance(part, Table)),
        )
        drawings[current()] = drawing
    return drawing


def _view(report: Report, number: int, on_paper: bool) -> RunView:
    recording = report.recordings.get(number)
    drawing = Drawing() if recording is None else draw(recording)
    output = report.output if number == 0 else text.plain(recording.output if recording else "")
    return RunView(
        **vars(drawing),
        number=number,
        title=_title(report, number),
        facts=report.varied_runs[number - 1] if number else report.run,
        picture=recorded_uri(report, number) if number else canvas_uri(report),
        expected=expected(report, drawing.plots) if number == 0 else {},
        pins=pins(report, number),
        output=text.clip(output.strip("\n"), _OUTPUT_LIMIT, keeps_end=True),
        on_paper=on_paper,
    )


def _title(report: Report, number: int) -> str:
    summary = report.varied_runs[number - 1] if number else report.run
    return wording.with_drawn(_name(summary, number), summary.drawn)


def _name(summary: RunSummary, number: int) -> str:
    if summary.case:
        return tr("Varied run {number}: case {case}", number=number, case=summary.case)
    start = summary.start
    if start is None:
        return wording.run_name(number)
    return tr(
        "Varied run {number}: {begins}; heading {heading:.0f}°",
        number=number,
        begins=start.words,
        heading=math.degrees(start.theta),
    )


def _script_data(shown: Animation) -> dict[str, Any]:
    """Return an animation as the script reads it; short names, because the lists are long."""
    return {
        "t": shown.times.round(2).tolist(),
        "cleared": list(shown.cleared),
        "tracks": [
            {
                "x": _numbers(track.x, 1),
                "y": _numbers(track.y, 1),
                "a": _numbers(-np.degrees(track.theta), 0),
                "ink": [
                    [first, last, pen.color, pen.width]
                    for first, last, pen in track.stretches
                    if pen.drawn
                ],
            }
            for track in shown.tracks
        ],
    }


def _numbers(values: Floats, digits: int) -> list[float | None]:
    rounded = values.round(digits).tolist()
    return [value if math.isfinite(value) else None for value in rounded]


FORMAT: Final = Format(
    msg("one self-contained page: picture, plots, animation, verdicts"), render, render_error
)
