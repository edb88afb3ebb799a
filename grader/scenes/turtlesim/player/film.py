"""A recorded run as a film: its inputs are played again, and every stroke is taken down.

That gives the recorded run to the last bit, in virtual time always. Where it does not (a clock of
its own decided when commands ran out), the film follows the recorded poses instead.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from grader.errors import RecordingError
from grader.language.phrase import say
from grader.scenes.scene import Start
from grader.scenes.turtlesim.player.followed import follow
from grader.scenes.turtlesim.player.reel import Place, Reel
from grader.scenes.turtlesim.trace import FIRST_TURTLE, SPRITE, TurtleTrace
from turtlesim_py.replay import ScenarioError, replay
from turtlesim_py.world.arena import Arena, UnknownTurtle
from turtlesim_py.world.canvas import Pen
from turtlesim_py.world.events import Clear, Reset, to_json
from turtlesim_py.world.notices import Notice
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
            say(
                "the run has {ticks} ticks; expected {most} at most, an hour, to play it",
                ticks=trace.ticks,
                most=MOST_TICKS,
            )
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
