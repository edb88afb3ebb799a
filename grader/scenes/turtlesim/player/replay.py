"""Animates a recorded run: replays its inputs, and records every stroke.

A replay gives the recorded run to the last bit, in virtual time always. Where it does not (in real
time the wall clock decides when a command runs out), the recorded poses are followed instead.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, Final

import numpy as np

from grader.errors import RecordingError
from grader.recording.subject import Start
from grader.scenes.turtlesim.driving import place
from grader.scenes.turtlesim.player.animation import Animation, Place
from grader.scenes.turtlesim.trace import SPRITE, TurtleTrace
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
    """The replay of the inputs differs from the recording."""


def animate(trace: TurtleTrace, start: Start | None) -> dict[str, Any]:
    """Return all frames of a run and all calls, as `page/animation.js` reads them.

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
        animation, is_exact = _replayed(trace, start), True
    except (_OtherRunError, ScenarioError, UnknownTurtle):
        animation, is_exact = follow(trace), False
    return {**animation.to_json(trace.ticks), "exact": is_exact, "calls": _calls(trace)}


def _calls(trace: TurtleTrace) -> list[dict[str, Any]]:
    """Return inputs and log lines by tick, in the order of the recording."""
    logs = [
        {"tick": log.tick, "op": "log", "severity": log.severity, "text": log.text}
        for log in trace.logs
    ]
    calls = [*map(to_json, trace.events), *logs]
    return sorted(calls, key=lambda call: int(call["tick"]))


def _replayed(trace: TurtleTrace, start: Start | None) -> Animation:
    """Animate a run by its inputs; raises _OtherRunError, ScenarioError, UnknownTurtle."""
    events = [to_json(event) for event in trace.events if 1 <= event.tick <= trace.ticks]
    recorder = _ReplayRecorder(trace, start)
    arena = replay({"ticks": trace.ticks, "events": events}, recorder).arena
    if not np.array_equal(arena.canvas.rgba(), trace.canvas):
        raise _OtherRunError
    return recorder.animation


class _ReplayRecorder:
    """Records a replay as an animation, and compares it with the recording.

    Attributes:
        animation: the frames up to now.
    """

    def __init__(self, trace: TurtleTrace, start: Start | None) -> None:
        self.animation = Animation()
        self._arena: Arena
        self._start = start
        self._recorded = {
            name: iter(way.rows().tolist()) for name, way in trace.trajectories.items()
        }

    def begin(self, arena: Arena) -> None:
        """Put the turtle where the run began, and record from here on."""
        self._arena = arena
        arena.sprite = SPRITE
        place(arena, self._start)
        arena.canvas.watcher = self._on_stroke
        arena.listeners.append(self._on_notice)
        self._record_frame({})

    def after_tick(self, arena: Arena, readings: Mapping[str, Reading]) -> None:
        """Compare the tick with the recorded one, and record a frame."""
        for name, (pose, color) in readings.items():
            recorded = next(self._recorded.get(name, iter(())), None)
            if recorded is None or not _is_same(recorded, (arena.ticks, *pose, *color)):
                raise _OtherRunError
        self._record_frame(readings)

    def _record_frame(self, readings: Mapping[str, Reading]) -> None:
        arena, animation = self._arena, self.animation
        animation.background(arena.ticks, arena.background)
        for name, turtle in arena.turtles.items():
            pose = readings[name].pose if name in readings else _pose(turtle)
            animation.turtle(arena.ticks, name, _place(turtle), pose)
            animation.pen(arena.ticks, name, turtle.pen, turtle.pen_on)

    def _on_stroke(self, pen: Pen, runs: Sequence[Span]) -> None:
        self.animation.stroke(self._arena.ticks + 1, (pen.r, pen.g, pen.b), runs)

    def _on_notice(self, notice: Notice) -> None:
        if isinstance(notice, Clear | Reset):
            self.animation.wipe(self._arena.ticks + 1)


def _place(turtle: Turtle) -> Place:
    return turtle.x_m * METER_PX, turtle.y_down_m * METER_PX, turtle.heading_rad


def _pose(turtle: Turtle) -> Pose:
    """Return the pose that a turtle would publish before its first update."""
    return Pose(turtle.x_m, SIZE_M - turtle.y_down_m, turtle.heading_rad, 0.0, 0.0)


def _is_same(recorded: Sequence[float], now: Sequence[float]) -> bool:
    return all(a == b or (a != a and b != b) for a, b in zip(recorded, now, strict=True))


_CHANNELS = ("background_r", "background_g", "background_b")


def follow(trace: TurtleTrace) -> Animation:
    """Animate a trace by its poses, pens and last picture.

    In real time the wall clock decided in which tick a command ran out, which is not recorded. So
    the strokes go from one published pose to the next and may differ from the true ones in single
    pixels; the last frame has the recorded picture.
    """
    follower = _PoseFollower(trace)
    for frame in range(trace.ticks + 1):
        follower.record_frame(frame)
    follower.end(trace.ticks)
    return follower.animation


class _PoseFollower:
    """Draws from one recorded pose to the next, tick by tick.

    Attributes:
        animation: the frames up to now.
    """

    def __init__(self, trace: TurtleTrace) -> None:
        self.animation = Animation()
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

    def record_frame(self, frame: int) -> None:
        """Record the next frame; frame 0 has the poses of frame 1."""
        self._frame = frame
        for event in self._events.get(frame, ()):
            self._apply(event)
        self.animation.background(frame, self._background)
        for name in sorted(self._rows):
            index = self._next[name]
            rows = self._rows[name]
            if index < len(rows) and rows[index][0] == max(frame, 1):
                self._next[name] = index + (frame > 0)
                self._move(name, Pose._make(rows[index][1:6]))

    def end(self, frame: int) -> None:
        """Replace the drawing in the last frame by the recorded picture."""
        self.animation.wipe(frame)
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
                    self.animation.stroke(frame, rgb, [(row, first, after - 1)])

    def _apply(self, event: Event) -> None:
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
                self.animation.wipe(self._frame)
            case Reset():
                self.animation.wipe(self._frame)
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
        self.animation.turtle(self._frame, name, self._last[name], pose)
        self.animation.pen(self._frame, name, pen, is_on)

    def _on_stroke(self, pen: Pen, runs: Sequence[Span]) -> None:
        self.animation.stroke(self._frame, (pen.r, pen.g, pen.b), runs)


def _is_still(before: Place, now: tuple[float, float]) -> bool:
    return fuzzy_equal(before[0], now[0]) and fuzzy_equal(before[1], now[1])
