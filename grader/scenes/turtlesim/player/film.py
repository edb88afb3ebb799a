"""A recorded run as a film: its inputs are played again, and every stroke is taken down.

That gives the recorded run to the last bit, in virtual time always. Where it does not (a clock of
its own decided when commands ran out), the film follows the recorded poses instead.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, Final

import numpy as np

from grader.errors import RecordingError
from grader.recording.subject import Start
from grader.scenes.turtlesim.player.reel import Place, Reel
from grader.scenes.turtlesim.trace import FIRST_TURTLE, SPRITE, TurtleTrace
from turtlesim_py.scenario import ScenarioError, replay
from turtlesim_py.world.arena import DEFAULT_BACKGROUND, Arena, UnknownTurtle
from turtlesim_py.world.canvas import Canvas, Pen
from turtlesim_py.world.events import (
    Clear,
    Event,
    Kill,
    Notice,
    Reset,
    SetParameter,
    SetPen,
    Spawn,
    to_json,
)
from turtlesim_py.world.floats import fuzzy_equal
from turtlesim_py.world.stroke import Span
from turtlesim_py.world.turtle import METER_PX, SIZE_M, Pose, Reading, Turtle

#: Longer recordings are not played: an hour.
MOST_TICKS: Final = 225_000


class _OtherRunError(Exception):
    """The inputs, played again, do not lead where the recording went."""


def film(trace: TurtleTrace, start: Start | None) -> dict[str, Any]:
    """All frames of a run and all calls, as `page/film.js` reads them.

    Args:
        start: where turtle1 began; None for the centre.

    Raises:
        RecordingError: it is too long.
    """
    if trace.ticks > MOST_TICKS:
        raise RecordingError(
            "the run has {ticks} ticks; expected {most} at most, an hour, to play it",
            ticks=trace.ticks,
            most=MOST_TICKS,
        )
    try:
        reel, is_exact = _played_again(trace, start), True
    except (_OtherRunError, ScenarioError, UnknownTurtle):
        reel, is_exact = follow(trace), False
    return {**reel.to_json(trace.ticks), "exact": is_exact, "calls": _calls(trace)}


def _calls(trace: TurtleTrace) -> list[dict[str, Any]]:
    """Inputs and log lines by tick, in the order of the recording."""
    logs = [
        {"tick": log.tick, "op": "log", "severity": log.severity, "text": log.text}
        for log in trace.logs
    ]
    calls = [*map(to_json, trace.events), *logs]
    return sorted(calls, key=lambda call: int(call["tick"]))


def _played_again(trace: TurtleTrace, start: Start | None) -> Reel:
    """Raises: _OtherRunError, ScenarioError, UnknownTurtle."""
    events = [to_json(event) for event in trace.events if 1 <= event.tick <= trace.ticks]
    camera = _Camera(trace, start)
    arena = replay({"ticks": trace.ticks, "events": events}, camera).arena
    if not np.array_equal(arena.canvas.rgba(), trace.canvas):
        raise _OtherRunError
    return camera.reel


class _Camera:
    """Sees a replay, and compares it with the recording.

    Attributes:
        reel: what it has taken.
    """

    def __init__(self, trace: TurtleTrace, start: Start | None) -> None:
        self.reel = Reel()
        self._arena: Arena
        self._start = start
        self._recorded = {
            name: iter(way.rows().tolist()) for name, way in trace.trajectories.items()
        }

    def begin(self, arena: Arena) -> None:
        """Put the turtle where it was, and look from now on."""
        self._arena = arena
        arena.sprite = SPRITE
        if self._start is not None:
            start = self._start
            arena.turtles[FIRST_TURTLE].place(start.x, start.y, start.theta)
        arena.canvas.watcher = self._on_stroke
        arena.listeners.append(self._on_notice)
        self._take({})

    def after_tick(self, arena: Arena, readings: Mapping[str, Reading]) -> None:
        """Compare the tick with the recorded one, and take a frame."""
        for name, (pose, color) in readings.items():
            recorded = next(self._recorded.get(name, iter(())), None)
            if recorded is None or not _is_same(recorded, (arena.ticks, *pose, *color)):
                raise _OtherRunError
        self._take(readings)

    def _take(self, readings: Mapping[str, Reading]) -> None:
        arena, reel = self._arena, self.reel
        reel.background(arena.ticks, arena.background)
        for name, turtle in arena.turtles.items():
            pose = readings[name].pose if name in readings else _pose(turtle)
            reel.turtle(arena.ticks, name, _place(turtle), pose)
            reel.pen(arena.ticks, name, turtle.pen, turtle.pen_on)

    def _on_stroke(self, pen: Pen, runs: Sequence[Span]) -> None:
        self.reel.stroke(self._arena.ticks + 1, (pen.r, pen.g, pen.b), runs)

    def _on_notice(self, notice: Notice) -> None:
        if isinstance(notice, Clear | Reset):
            self.reel.wipe(self._arena.ticks + 1)


def _place(turtle: Turtle) -> Place:
    return turtle.x_m * METER_PX, turtle.y_down_m * METER_PX, turtle.heading_rad


def _pose(turtle: Turtle) -> Pose:
    """As it would be published by one that has not been updated yet."""
    return Pose(turtle.x_m, SIZE_M - turtle.y_down_m, turtle.heading_rad, 0.0, 0.0)


def _is_same(recorded: Sequence[float], now: Sequence[float]) -> bool:
    return all(a == b or (a != a and b != b) for a, b in zip(recorded, now, strict=True))


_CHANNELS = ("background_r", "background_g", "background_b")


def follow(trace: TurtleTrace) -> Reel:
    """The film of a trace, from its poses, pens and last picture.

    In real time the wall clock decided in which tick a command ran out, and no recording has it. So
    the strokes go from one published pose to the next, which may differ from the true ones in
    single pixels; the last frame has the recorded picture.
    """
    made = _Follower(trace)
    for frame in range(trace.ticks + 1):
        made.go_on(frame)
    made.end(trace.ticks)
    return made.reel


class _Follower:
    """Goes along, tick by tick.

    Attributes:
        reel: what it has taken.
    """

    def __init__(self, trace: TurtleTrace) -> None:
        self.reel = Reel()
        self._trace = trace
        self._frame = 0
        self._background = list(DEFAULT_BACKGROUND)
        self._canvas = Canvas()
        self._canvas.watcher = self._on_stroke
        self._pens: dict[str, tuple[Pen, bool]] = {}
        self._last: dict[str, Place] = {}
        self._events: dict[int, list[Event]] = defaultdict(list)
        for event in trace.events:
            self._events[event.tick].append(event)
        self._rows = {name: way.rows().tolist() for name, way in trace.trajectories.items()}
        self._next = dict.fromkeys(self._rows, 0)

    def go_on(self, frame: int) -> None:
        """Take the next frame; frame 0 is as frame 1 was."""
        self._frame = frame
        for event in self._events.get(frame, ()):
            self._hear(event)
        self.reel.background(frame, self._background)
        for name in sorted(self._rows):
            index = self._next[name]
            rows = self._rows[name]
            if index < len(rows) and rows[index][0] == max(frame, 1):
                self._next[name] = index + (frame > 0)
                self._move(name, Pose._make(rows[index][1:6]))

    def end(self, frame: int) -> None:
        """Have the recorded picture in the last frame."""
        self.reel.wipe(frame)
        canvas = self._trace.canvas
        painted = canvas[..., 3] != 0
        packed = canvas.astype(np.int64) @ np.array([1 << 16, 1 << 8, 1, 0])
        packed[~painted] = -1
        for row, values in enumerate(packed):
            edges = [0, *(np.flatnonzero(np.diff(values)) + 1).tolist(), len(values)]
            for first, after in pairwise(edges):
                color = int(values[first])
                if color >= 0:
                    rgb = (color >> 16, color >> 8 & 255, color & 255)
                    self.reel.stroke(frame, rgb, [(row, first, after - 1)])

    def _hear(self, event: Event) -> None:
        match event:
            case SetPen(turtle=name):
                pen, _ = self._pens.get(name, (Pen(), True))
                if not event.off:
                    pen = Pen(event.r, event.g, event.b, event.width)
                self._pens[name] = (pen, not event.off)
            case Spawn(name=name) | Kill(name=name):
                self._last.pop(name, None)
                self._pens.pop(name, None)
            case Clear():
                self.reel.wipe(self._frame)
            case Reset():
                self.reel.wipe(self._frame)
                self._last.clear()
                self._pens.clear()
            case SetParameter(name=name, value=int(value)) if name in _CHANNELS:
                self._background[_CHANNELS.index(name)] = value & 255

    def _move(self, name: str, pose: Pose) -> None:
        x, y = pose.x * METER_PX, (SIZE_M - pose.y) * METER_PX
        pen, is_on = self._pens.get(name, (Pen(), True))
        before = self._last.get(name)
        if is_on and before is not None and not _is_still(before, (x, y)):
            self._canvas.draw_line(x, y, before[0], before[1], pen)
        self._last[name] = (x, y, pose.theta)
        self.reel.turtle(self._frame, name, self._last[name], pose)
        self.reel.pen(self._frame, name, pen, is_on)

    def _on_stroke(self, pen: Pen, runs: Sequence[Span]) -> None:
        self.reel.stroke(self._frame, (pen.r, pen.g, pen.b), runs)


def _is_still(before: Place, now: tuple[float, float]) -> bool:
    return fuzzy_equal(before[0], now[0]) and fuzzy_equal(before[1], now[1])
