"""A recorded run for a page: tracks in pixels with their pens, and curves over time.

Its texts are made by `words.py`.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from grader.scenes.turtlesim import words
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from grader.scenes.view import Call, Curve, Floats, PenChange, Plane, Rest, Track, View
from grader.text.message import NOTHING, Message, msg
from turtlesim_py.world.arena import TICK_NS
from turtlesim_py.world.canvas import Pen
from turtlesim_py.world.events import Clear, CmdVel, Event, Reset, SetPen
from turtlesim_py.world.stroke import SIZE_PX
from turtlesim_py.world.trajectory import Trajectory
from turtlesim_py.world.turtle import METER_PX, SIZE_M, TICK_S

PLANE = Plane(SIZE_PX, METER_PX, SIZE_M)


def view(trace: TurtleTrace) -> View:
    names = list(trace.trajectories)
    first = FIRST_TURTLE if FIRST_TURTLE in names else next(iter(names), None)
    names.sort(key=lambda name: (name != first, name))
    background = _background(trace)
    cleared = [event.tick * TICK_NS for event in trace.events if isinstance(event, Clear | Reset)]
    return View(
        tracks=tuple(_track(trace, name) for name in names),
        step_ns=TICK_NS,
        cleared=tuple(cleared),
        background=background,
        rest=None if first is None else _rest(trace.trajectories[first]),
        curves=() if first is None else _curves(trace, first),
        calls=tuple(_call(event, trace) for event in trace.events if not isinstance(event, CmdVel)),
        drawn=words.drawn(trace.canvas, background),
    )


def _track(trace: TurtleTrace, name: str) -> Track:
    way = trace.trajectories[name]
    pen = Pen()
    pens = [PenChange(0, _hex(pen.r, pen.g, pen.b), pen.width)]
    for event in trace.of_kind(SetPen, name):
        last = pens[-1]
        if event.off:
            pens.append(PenChange(event.tick * TICK_NS, last.color, last.width, drawn=False))
        else:
            color = _hex(event.r, event.g, event.b)
            pens.append(PenChange(event.tick * TICK_NS, color, event.width))
    x, y = way.x * METER_PX, (SIZE_M - way.y) * METER_PX
    return Track(name, way.ticks * TICK_NS, x, y, way.theta, tuple(pens))


def _rest(way: Trajectory) -> Rest | None:
    """Return the rest at the end; None if it was moving, never moved, or has no finite place."""
    moved = np.flatnonzero((np.diff(way.x) != 0) | (np.diff(way.y) != 0)) + 1
    if not len(moved) or moved[-1] == len(way) - 1:
        return None
    if not np.isfinite([way.x[-1], way.y[-1]]).all():
        return None
    last = int(moved[-1])
    return Rest(float(way.x[last]), float(way.y[last]), float(way.ticks[last]) * TICK_S)


def _curves(trace: TurtleTrace, name: str) -> tuple[Curve, ...]:
    way = trace.trajectories[name]
    times_ns = way.ticks * TICK_NS
    distance = np.hypot(way.x - SIZE_M / 2, way.y - SIZE_M / 2)
    every_tick = np.arange(1, trace.ticks + 1, dtype=np.int64) * TICK_NS
    return (
        Curve(msg("Distance from the centre of the window"), "m", times_ns, distance),
        Curve(msg("Speed"), "m/s", times_ns, way.linear),
        Curve(msg("Angular velocity"), "rad/s", times_ns, way.angular),
        Curve(msg("Rate of velocity commands"), "Hz", every_tick, _rate(trace, name)),
    )


def _rate(trace: TurtleTrace, name: str) -> Floats:
    """Return velocity commands a second for each tick, over the interval up to each command."""
    rate = np.zeros(trace.ticks)
    ticks, counts = np.unique(
        np.array([command.tick for command in trace.of_kind(CmdVel, name)], dtype=np.int64),
        return_counts=True,
    )
    for start, stop, count in zip(ticks[:-1], ticks[1:], counts[1:], strict=True):
        rate[start:stop] = count / ((stop - start) * TICK_S)
    return rate


def _call(event: Event, trace: TurtleTrace) -> Call:
    color = _hex(event.r, event.g, event.b) if isinstance(event, SetPen) else ""
    way = trace.trajectories.get(getattr(event, "turtle", ""))
    where = NOTHING if way is None else _where(way, event.tick)
    return Call(event.op, event.tick * TICK_NS, color, words.asked_for(event), where)


def _where(way: Trajectory, tick: int) -> Message:
    """Return the part of the window that it was in, in a tick or the last one before it."""
    row = int(np.searchsorted(way.ticks, tick, side="right")) - 1
    return words.quarter(float(way.x[row]), float(way.y[row])) if row >= 0 else NOTHING


def _background(trace: TurtleTrace) -> str:
    """Return the commonest colour of the window where nothing is painted."""
    unpainted: npt.NDArray[np.uint8] = trace.window[trace.canvas[..., 3] == 0]
    if not len(unpainted):
        return "#4556ff"
    # as whole numbers, which sort fifty times faster than rows, and in the same order
    packed = unpainted.astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], dtype=np.uint32)
    colors, counts = np.unique(packed, return_counts=True)
    return f"#{int(colors[int(np.argmax(counts))]):06x}"


def _hex(r: int, g: int, b: int) -> str:
    return f"#{r:02x}{g:02x}{b:02x}"
