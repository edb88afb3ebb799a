"""Records an arena: its inputs, the way of each turtle, the log, and the drawing."""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import replace

from grader.recording.subject import Start
from grader.scenes.turtlesim.trace import Log, TurtleTrace
from turtlesim_py.world import picture
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.events import Event, LogLine, Notice, from_json, to_json
from turtlesim_py.world.trajectory import Trajectory
from turtlesim_py.world.turtle import Reading


def place(arena: Arena, start: Start | None) -> None:
    """Prepare an arena for a run, without a stroke; None leaves turtle1 in the centre."""
    if start is not None:
        arena.begin_at(start.x, start.y, start.theta, start.speed, start.turn)


class Recorder:
    """Records an arena: its events, and its readings by `record` after each tick."""

    def __init__(self, arena: Arena, most_logs: float = math.inf) -> None:
        """Keep at most `most_logs` lines of the log."""
        self.ticks = 0
        self._most_logs = most_logs
        self._arena = arena
        self._events: list[Event] = []
        self._logs: list[Log] = []
        self._readings: dict[str, list[tuple[int, Reading]]] = defaultdict(list)
        arena.listeners.append(self._listen)

    def record(self, readings: dict[str, Reading]) -> None:
        self.ticks += 1
        for name, reading in readings.items():
            self._readings[name].append((self.ticks, reading))

    def trace(self) -> TurtleTrace:
        arena = self._arena
        return TurtleTrace(
            ticks=self.ticks,
            # through JSON: a recorded event equals one that is read from a bag
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
