"""The news of an arena for viewers: the whole picture once, then strokes and moves.

Runs in the simulator's thread, after each tick, and delivers plain data; it never waits. While
nobody watches, nothing is collected.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Protocol

from turtlesim_py.world.arena import Arena
from turtlesim_py.world.canvas import Canvas, Pen
from turtlesim_py.world.events import Clear, Event, LogLine, Notice, Reset, to_json
from turtlesim_py.world.floats import json_number
from turtlesim_py.world.stroke import Span
from turtlesim_py.world.turtle import METER_PX, Reading, Turtle

#: Changes of this many ticks are delivered together: 31 times a second.
TICKS_TOGETHER = 2
#: The most calls that one change names; a flood of them is no news.
MOST_CALLS = 20
#: A number as in events: JSON has none for infinities and what is no number.
_json = partial(json_number, digits=17)


@dataclass(frozen=True)
class News:
    """Changes of an arena for all viewers, or all of it for one that has come or missed something.

    Attributes:
        content: as the page gets it; `docs/live.md` describes it.
        canvas: with all of an arena, a copy of its paint.
        viewer: that has asked for all.
    """

    content: Mapping[str, Any]
    canvas: Canvas | None = None
    viewer: object = None


Deliver = Callable[[News], None]


class Source(Protocol):
    """Delivers the news of an arena.

    Attributes:
        is_watched: whether anybody wants changes; set from any thread.
    """

    is_watched: bool

    def ask(self, viewer: object) -> None:
        """Request all of the arena for a viewer; from any thread."""


class Feed:
    """A `Source` that collects the changes of an arena.

    Args:
        deliver: called in the simulator's thread.
        together: changes of so many ticks travel together.
    """

    def __init__(self, arena: Arena, deliver: Deliver, together: int = TICKS_TOGETHER) -> None:
        self._arena = arena
        self._deliver = deliver
        self._together = together
        self.is_watched = False
        self._asking: deque[object] = deque()
        self._drawn: list[Any] = []
        self._calls: list[Any] = []
        #: background and turtles as delivered last
        self._delivered: Mapping[str, Any] = {}
        self._readings: Mapping[str, Reading] = {}
        arena.listeners.append(self._on_notice)

    def ask(self, viewer: object) -> None:
        """Request all of the arena for a viewer, after the next tick; from any thread."""
        self._asking.append(viewer)

    def after_tick(self, readings: Mapping[str, Reading]) -> None:
        """Deliver the news up to now; `readings` is what the tick has published."""
        canvas = self._arena.canvas
        if not (self.is_watched or self._asking):
            if canvas.watcher is not None:
                canvas.watcher = None
                self._drawn, self._calls, self._delivered = [], [], {}
            return
        canvas.watcher = self._on_stroke
        self._readings = readings or self._readings
        if self._asking or self._arena.ticks % self._together == 0:
            self._deliver_change()
        if self._asking:
            whole = News({"tick": self._arena.ticks, **self._delivered}, canvas.copy())
            while self._asking:
                self._deliver(replace(whole, viewer=self._asking.popleft()))

    def _deliver_change(self) -> None:
        arena = self._arena
        ordered = (arena.turtles[name] for name in sorted(arena.turtles))
        turtles = [_row(turtle, self._readings.get(turtle.name)) for turtle in ordered]
        state = {"background": arena.background, "turtles": turtles}
        changed = {} if state == self._delivered else state
        if changed or self._drawn or self._calls:
            content = {"tick": arena.ticks, "drawn": self._drawn, "calls": self._calls}
            self._delivered, self._drawn, self._calls = state, [], []
            self._deliver(News(content | changed))

    def _on_stroke(self, pen: Pen, runs: Sequence[Span]) -> None:
        color = [pen.r, pen.g, pen.b]
        numbers = [number for run in runs for number in run]
        if self._drawn and self._drawn[-1] is not None and self._drawn[-1][0] == color:
            self._drawn[-1][1].extend(numbers)
        else:
            self._drawn.append([color, numbers])

    def _on_notice(self, notice: Notice) -> None:
        if self._arena.canvas.watcher is None:
            return
        if isinstance(notice, Clear | Reset):
            self._drawn = [None]  # what was drawn before is gone
        if isinstance(notice, Event):
            self._calls.append(to_json(notice))
        elif isinstance(notice, LogLine):
            line = {"op": "log", "severity": notice.severity, "text": notice.text}
            self._calls.append({**line, "tick": self._arena.ticks})
        del self._calls[:-MOST_CALLS]


def _row(turtle: Turtle, reading: Reading | None) -> Mapping[str, Any]:
    """Return a turtle as the page gets it: its place [px, rad], and its published values."""
    pen = turtle.pen
    row: dict[str, Any] = {
        "name": turtle.name,
        "sprite": turtle.sprite,
        "px": [_json(turtle.x_m * METER_PX), _json(turtle.y_down_m * METER_PX)],
        "heading": _json(turtle.heading_rad),
        "pen": {"r": pen.r, "g": pen.g, "b": pen.b, "width": pen.width, "off": not turtle.pen_on},
    }
    if reading is not None:
        row["pose"] = [_json(value) for value in reading.pose]
        row["color"] = list(reading.color)
    return row
