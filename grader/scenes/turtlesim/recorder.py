"""Takes down what happens in an arena while it happens."""

from __future__ import annotations

from collections import defaultdict
from typing import Any

import numpy as np

from grader.recording.recording import Recording, Run
from turtlesim_py.replay import COLUMNS, number
from turtlesim_py.world import picture
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.events import Event, Input, LogLine
from turtlesim_py.world.turtle import Reading


class Recorder:
    """Listens to an arena; `take` belongs after each of its ticks."""

    def __init__(self, arena: Arena) -> None:
        self.ticks = 0
        self._arena = arena
        self._events: list[dict[str, Any]] = []
        self._logs: list[list[Any]] = []
        self._rows: dict[str, list[tuple[float, ...]]] = defaultdict(list)
        arena.listeners.append(self._listen)

    def take(self, readings: dict[str, Reading]) -> None:
        """Record what every turtle has published in this tick."""
        self.ticks += 1
        for name, (pose, color) in readings.items():
            self._rows[name].append((self.ticks, *pose, *color))

    def recording(self, topics: tuple[dict[str, str], ...] = ()) -> Recording:
        """Everything up to now."""
        arena = self._arena
        return Recording(
            events=tuple(self._events),
            published={
                name: np.array(rows, dtype=np.float64).reshape(-1, len(COLUMNS))
                for name, rows in self._rows.items()
            },
            logs=tuple(self._logs),
            canvas=arena.canvas.rgba(),
            window=picture.render(arena.canvas, arena.background, arena.sprites()),
            topics=topics,
            run=Run(ticks=self.ticks),
        )

    def _listen(self, event: Event) -> None:
        tick = self.ticks + 1
        if isinstance(event, Input):
            args = {key: _plain(value) for key, value in event.args.items()}
            self._events.append({"tick": tick, "op": event.op, **args})
        elif isinstance(event, LogLine):
            self._logs.append([tick, event.severity, "turtlesim", event.text])


def _plain(value: Any) -> Any:
    """A value that JSON can hold: NaN and infinities as strings, goal ids as hexadecimal."""
    if isinstance(value, bytes):
        return value.hex()
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    return number(value, 17) if isinstance(value, float) else value
