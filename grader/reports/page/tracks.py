"""A recording as a page draws it: where the turtles went, thinned out, and what their pens did."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from grader.recording.recording import Recording
from turtlesim_py.world.canvas import Pen
from turtlesim_py.world.turtle import METER_PX, SIZE_M, TICK_S

Floats = npt.NDArray[np.float64]

#: A track has no more samples than this, however long the run.
_SAMPLES = 1000
#: More turtles than this are not drawn; a submission can spawn any number.
_TURTLES = 5
#: The turtle that velocity commands of an exercise go to, if it is there.
_FIRST_TURTLE = "turtle1"


@dataclass(frozen=True)
class Stretch:
    """A part of a way with one pen, from one sample to another; `drawn` unless the pen was off."""

    first: int
    last: int
    color: str
    width: int
    drawn: bool


@dataclass(frozen=True)
class Track:
    """The way of one turtle.

    Attributes:
        name: the turtle's.
        x, y: where it was at each sample [px, y down]; NaN where it was not there.
        theta: its heading at each sample [rad].
        stretches: the way in parts, one for each pen.
    """

    name: str
    x: Floats
    y: Floats
    theta: Floats
    stretches: tuple[Stretch, ...]

    def path(self) -> str:
        """The way as the `d` of an SVG path."""
        return svg_path(self.x, self.y)

    def lifted(self) -> str:
        """The stretches of the way on which the pen was off."""
        return "".join(
            svg_path(self.x[s.first : s.last + 1], self.y[s.first : s.last + 1])
            for s in self.stretches
            if not s.drawn
        )


@dataclass(frozen=True)
class Rest:
    """A turtle stands still at (x, y) [m] from `time_s` on."""

    x: float
    y: float
    time_s: float


@dataclass(frozen=True)
class Film:
    """All tracks of a run at common samples.

    Attributes:
        times: of the samples [s].
        tracks: the turtle of the exercise first.
        cleared: samples at which everything drawn before vanished.
        background: the window's colour.
        rest: where the exercise's turtle stood still at the end, if it had moved before.
    """

    times: Floats
    tracks: tuple[Track, ...]
    cleared: tuple[int, ...]
    background: str
    rest: Rest | None


def to_px(x: float, y: float) -> tuple[float, float]:
    """A place in metres (y up) as pixels of the window (y down)."""
    return x * METER_PX, (SIZE_M - y) * METER_PX


def main_turtle(recording: Recording) -> str | None:
    """The turtle that plots are about."""
    names = list(recording.published)
    return _FIRST_TURTLE if _FIRST_TURTLE in names else next(iter(names), None)


def film(recording: Recording) -> Film:
    """Thin a recording out to what an animation needs."""
    ticks = _sample_ticks(recording.run.ticks)
    first = main_turtle(recording)
    names = sorted(recording.published, key=lambda name: (name != first, name))[:_TURTLES]
    cleared = [e["tick"] for e in recording.events if e["op"] in ("clear", "reset")]
    return Film(
        np.asarray(ticks * TICK_S, dtype=np.float64),
        tuple(_track(recording, name, ticks) for name in names),
        tuple(sorted({int(np.searchsorted(ticks, tick)) for tick in cleared})),
        _background(recording),
        _rest(recording, first),
    )


def svg_path(x: Floats, y: Floats) -> str:
    """A line through points, interrupted where one is not finite."""
    parts: list[str] = []
    pen_down = False
    for a, b in zip(x.round(1).tolist(), y.round(1).tolist(), strict=True):
        if np.isfinite(a) and np.isfinite(b):
            parts.append(f"{'L' if pen_down else 'M'}{a:g} {b:g}")
            pen_down = True
        else:
            pen_down = False
    return "".join(parts)


def _sample_ticks(ticks: int) -> npt.NDArray[np.int64]:
    """Every so many ticks, and the last one."""
    step = max(1, -(-ticks // _SAMPLES))
    samples = np.arange(1, ticks + 1, step, dtype=np.int64)
    if ticks and samples[-1] != ticks:
        samples = np.append(samples, ticks)
    return samples


def _track(recording: Recording, name: str, ticks: npt.NDArray[np.int64]) -> Track:
    rows = recording.published[name]
    at = np.searchsorted(rows[:, 0], ticks)
    there = np.isin(ticks, rows[:, 0])
    columns = np.full((3, len(ticks)), np.nan)
    columns[:, there] = rows[at[there], 1:4].T
    stretches = _stretches(recording, name, ticks)
    return Track(
        name, columns[0] * METER_PX, (SIZE_M - columns[1]) * METER_PX, columns[2], stretches
    )


def _rest(recording: Recording, name: str | None) -> Rest | None:
    rows = recording.published[name] if name is not None else np.zeros((0, 9))
    moved = np.flatnonzero(np.any(np.diff(rows[:, 1:3], axis=0) != 0, axis=1)) + 1
    if not len(moved) or moved[-1] == len(rows) - 1 or not np.isfinite(rows[-1, 1:3]).all():
        return None
    tick, x, y = rows[moved[-1], :3].tolist()
    return Rest(x, y, tick * TICK_S)


def _stretches(
    recording: Recording, name: str, ticks: npt.NDArray[np.int64]
) -> tuple[Stretch, ...]:
    """The way by pens; of several changes between two samples the last counts."""
    changes: dict[int, dict[str, Any]] = {
        int(np.searchsorted(ticks, call["tick"])): call for call in recording.calls("set_pen", name)
    }
    default = Pen()
    color, width, drawn = _hex(default.r, default.g, default.b), default.width, True
    stretches: list[Stretch] = []
    start = 0
    for sample, call in [*sorted(changes.items()), (len(ticks) - 1, {})]:
        # The stroke that leads to the sample of a change has the new colour already.
        end = max(sample - 1, start) if call else sample
        if end > start:
            stretches.append(Stretch(start, end, color, width, drawn))
        start = end
        if call:
            drawn = not call["off"]
            if drawn:
                color, width = _hex(call["r"], call["g"], call["b"]), call["width"]
    return tuple(stretches)


def _hex(r: int, g: int, b: int) -> str:
    return f"#{r:02x}{g:02x}{b:02x}"


def _background(recording: Recording) -> str:
    """The commonest colour of the window where nothing is painted."""
    unpainted = recording.window[recording.canvas[..., 3] == 0]
    if not len(unpainted):
        return "#4556ff"
    colors, counts = np.unique(unpainted, axis=0, return_counts=True)
    r, g, b = colors[int(np.argmax(counts))].tolist()
    return _hex(r, g, b)
