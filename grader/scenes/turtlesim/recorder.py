"""Takes down what happens in an arena while it happens."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from math import inf

from grader.scenes.turtlesim.trace import Log, TurtleTrace
from turtlesim_py.world import picture
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.events import Event, from_json, to_json
from turtlesim_py.world.notices import LogLine, Notice
from turtlesim_py.world.trajectory import Trajectory
from turtlesim_py.world.turtle import Reading


class Recorder:
    """Listens to an arena; `take` belongs after each of its ticks."""

    def __init__(self, arena: Arena, most_logs: float = inf) -> None:
        """Of the lines of the log, the first `most_logs` are kept."""
        self.ticks = 0
        self._most_logs = most_logs
        self._arena = arena
        self._events: list[Event] = []
        self._logs: list[Log] = []
        self._readings: dict[str, list[tuple[int, Reading]]] = defaultdict(list)
        arena.listeners.append(self._listen)

    def take(self, readings: dict[str, Reading]) -> None:
        """Record what every turtle has published in this tick."""
        self.ticks += 1
        for name, reading in readings.items():
            self._readings[name].append((self.ticks, reading))

    def trace(self) -> TurtleTrace:
        """Everything up to now."""
        arena = self._arena
        return TurtleTrace(
            ticks=self.ticks,
            # through JSON: an event is the same whether it was recorded or read from a bag
            events=tuple(from_json(to_json(event)) for event in self._events),
            trajectories={
                name: Trajectory.of_readings(readings) for name, readings in self._readings.items()
            },
            logs=tuple(self._logs),
            canvas=arena.canvas.rgba(),
            window=picture.render(arena.canvas, arena.background, arena.sprites()),
        )

    def _listen(self, notice: Notice) -> None:
        tick = self.ticks + 1
        if isinstance(notice, Event):
            self._events.append(replace(notice, tick=tick))
        elif isinstance(notice, LogLine) and len(self._logs) < self._most_logs:
            self._logs.append(Log(tick, notice.severity, "turtlesim", notice.text))
