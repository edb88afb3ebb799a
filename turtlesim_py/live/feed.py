"""What viewers are told of an arena: the whole picture once, then what is drawn and who moves.

Runs in the simulator's thread, after each tick, and hands on plain data; it never waits. While
nobody looks, nothing is collected.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from turtlesim_py.world.arena import Arena
from turtlesim_py.world.canvas import Canvas, Pen
from turtlesim_py.world.events import Clear, Event, Reset, to_json
from turtlesim_py.world.floats import json_number
from turtlesim_py.world.notices import LogLine, Notice
from turtlesim_py.world.stroke import Span
from turtlesim_py.world.turtle import METER_PX, Reading, Turtle

#: Changes of so many ticks travel together: 31 times a second.
TICKS_TOGETHER = 2
#: Of the calls in one change so many are told; a flood of them is no news.
MOST_CALLS = 20


@dataclass(frozen=True)
class Change:
    """What became of the arena in some ticks.

    Attributes:
        content: as the page gets it; `docs/live.md` says what is in it.
    """

    content: Mapping[str, Any]


@dataclass(frozen=True)
class Whole:
    """All of the arena, for one who has just come or has missed something.

    Attributes:
        viewer: whoever has asked.
        canvas: a copy.
        content: the rest, as the page gets it.
    """

    viewer: object
    canvas: Canvas
    content: Mapping[str, Any]


#: Gets each change, and what was asked for.
Deliver = Callable[[Change | Whole], None]


class Source(Protocol):
    """Whatever knows of an arena what viewers are to be told.

    Attributes:
        is_watched: whether anybody wants changes; set from any thread.
    """

    is_watched: bool

    def ask(self, viewer: object) -> None:
        """Have all of the arena delivered for a viewer; from any thread."""


class Feed:
    """Collects what happens in an arena.

    Args:
        deliver: called in the simulator's thread.
        together: changes of so many ticks travel together.

    Attributes:
        is_watched: whether anybody wants changes; set from any thread.
    """

    def __init__(self, arena: Arena, deliver: Deliver, together: int = TICKS_TOGETHER) -> None:
        self._arena = arena
        self._deliver = deliver
        self._together = together
        self.is_watched = False
        self._asked: deque[object] = deque()
        self._drawn: list[Any] = []
        self._calls: list[Any] = []
        self._told: tuple[Any, ...] = ()
        self._readings: Mapping[str, Reading] = {}
        arena.listeners.append(self._on_notice)

    def ask(self, viewer: object) -> None:
        """Have all of the arena delivered for a viewer after the next tick; from any thread."""
        self._asked.append(viewer)

    def after_tick(self, readings: Mapping[str, Reading]) -> None:
        """Deliver what there is; `readings` is what the tick has published."""
        if not (self.is_watched or self._asked):
            if self._arena.canvas.watcher is not None:
                self._forget()
            return
        self._arena.canvas.watcher = self._on_stroke
        self._readings = readings or self._readings
        if self._asked:
            self._deliver_change()
            self._deliver_wholes()
        elif self._arena.ticks % self._together == 0:
            self._deliver_change()

    def _forget(self) -> None:
        self._arena.canvas.watcher = None
        self._drawn, self._calls, self._told = [], [], ()

    def _deliver_change(self) -> None:
        state = self._state()
        if state == self._told and not self._drawn and not self._calls:
            return
        content = {"tick": self._arena.ticks, "drawn": self._drawn, "calls": self._calls}
        if state != self._told:
            content |= dict(zip(("background", "turtles"), state, strict=True))
        self._told, self._drawn, self._calls = state, [], []
        self._deliver(Change(content))

    def _deliver_wholes(self) -> None:
        background, turtles = self._told = self._state()
        content = {"tick": self._arena.ticks, "background": background, "turtles": turtles}
        canvas = self._arena.canvas.copy()
        while self._asked:
            self._deliver(Whole(self._asked.popleft(), canvas, content))

    def _state(self) -> tuple[Sequence[int], Sequence[Mapping[str, Any]]]:
        arena = self._arena
        ordered = (arena.turtles[name] for name in sorted(arena.turtles))
        return arena.background, [
            _row(turtle, self._readings.get(turtle.name)) for turtle in ordered
        ]

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
            said = {"op": "log", "severity": notice.severity, "text": notice.text}
            self._calls.append({**said, "tick": self._arena.ticks})
        del self._calls[:-MOST_CALLS]


def _row(turtle: Turtle, reading: Reading | None) -> Mapping[str, Any]:
    """A turtle as the page gets it: where to draw it [px, rad], and what it has published."""
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


def _json(value: float) -> float | int | str:
    """As in events: JSON has no word for what is no number, nor for infinities."""
    return json_number(value, 17)
