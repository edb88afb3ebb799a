"""A film of what was published, where the inputs alone do not tell all.

In real time the wall clock decided in which tick a command ran out, and no recording has it. So the
strokes go from one published pose to the next, which may differ from the true ones in single
pixels; the last frame has the recorded picture.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from grader.scenes.turtlesim.player.reel import Place, Reel
from grader.scenes.turtlesim.trace import TurtleTrace
from turtlesim_py.world.arena import DEFAULT_BACKGROUND
from turtlesim_py.world.canvas import Canvas, Pen
from turtlesim_py.world.events import Clear, Event, Kill, Reset, SetParameter, SetPen, Spawn
from turtlesim_py.world.floats import fuzzy_equal
from turtlesim_py.world.stroke import Span
from turtlesim_py.world.turtle import METER_PX, SIZE_M, Pose

_CHANNELS = ("background_r", "background_g", "background_b")


def follow(trace: TurtleTrace) -> Reel:
    """The film of a trace, from its poses, pens and last picture."""
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
