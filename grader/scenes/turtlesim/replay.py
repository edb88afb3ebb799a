"""Animates a recorded run: replays its inputs, and records every stroke.

A replay gives the recorded run to the last bit, in virtual time always. Where it does not (in real
time the wall clock decides when a command runs out), the recorded poses are followed instead.

A frame is the picture after a tick; frame 0 is that before the first. Columns are sent as bytes in
base64, little-endian, so that NaN, infinities and every last bit arrive.
"""

from __future__ import annotations

import base64
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from grader.errors import RecordingError
from grader.recording.subject import Start
from grader.scenes.turtlesim.recorder import place
from grader.scenes.turtlesim.trace import SPRITE, TurtleTrace
from turtlesim_py.scenario import apply
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.canvas import Pen
from turtlesim_py.world.events import Clear, Notice, Reset, to_json
from turtlesim_py.world.stroke import SIZE_PX, Span
from turtlesim_py.world.turtle import METER_PX, SIZE_M, Pose, Turtle

#: Longer recordings are not played: an hour.
MOST_TICKS: Final = 225_000
Color = tuple[int, int, int]
#: Centre on the canvas [px, y down] and heading [rad].
Place = tuple[float, float, float]
#: In place of a colour: all paint is wiped.
WIPED: Final = -1


def animate(trace: TurtleTrace, start: Start | None) -> dict[str, Any]:
    """Return all frames of a run and all calls, as `page/animation.js` reads them.

    Args:
        start: where turtle1 began; None for the centre.
    """
    if trace.ticks > MOST_TICKS:
        raise RecordingError(
            "the run has {ticks} ticks; expected {most} at most, an hour, to play it",
            ticks=trace.ticks,
            most=MOST_TICKS,
        )
    replay = _Replay(trace, start)
    is_exact = replay.goes_as_recorded()
    if not is_exact:
        way = trace.trajectory()
        seen = Start(*map(float, (way.x[0], way.y[0], way.theta[0]))) if len(way) else None
        replay = _Replay(trace, seen)
        replay.follow()
    return {**replay.animation.to_json(trace.ticks), "exact": is_exact, "calls": _calls(trace)}


def _calls(trace: TurtleTrace) -> list[dict[str, Any]]:
    """Return inputs and log lines by tick, in the order of the recording."""
    logs = [
        {"tick": log.tick, "op": "log", "severity": log.severity, "text": log.text}
        for log in trace.logs
    ]
    calls = [*map(to_json, trace.events), *logs]
    return sorted(calls, key=lambda call: int(call["tick"]))


class _Replay:
    """An arena that gets the recorded inputs again, as an animation.

    Attributes:
        animation: the frames up to now.
    """

    def __init__(self, trace: TurtleTrace, start: Start | None) -> None:
        self.animation = Animation()
        self._trace = trace
        self._inputs = trace.by_tick()
        self._frame = 0
        self._arena = arena = Arena(sprite=SPRITE)
        place(arena, start)
        arena.canvas.watcher = self._on_stroke
        arena.listeners.append(self._on_notice)
        #: tick -> turtle -> its row in the recording
        self._rows: dict[int, dict[str, list[float]]] = {}
        for name, way in trace.trajectories.items():
            for row in way.rows().tolist():
                self._rows.setdefault(int(row[0]), {})[name] = row[1:]
        self._record({name: _pose(turtle) for name, turtle in arena.turtles.items()})

    def goes_as_recorded(self) -> bool:
        """Let the turtles obey; whether that is the recorded run, to the last bit."""
        for _ in range(self._trace.ticks):
            recorded = self._begin_tick()
            readings = self._arena.tick()
            for name, (pose, color) in readings.items():
                if name not in recorded or not _is_same(recorded[name], (*pose, *color)):
                    return False
            self._record({name: reading.pose for name, reading in readings.items()})
        return np.array_equal(self._arena.canvas.rgba(), self._trace.canvas)

    def follow(self) -> None:
        """Take the turtles from each recorded pose to the next.

        In real time the wall clock decided in which tick a command ran out, which is not recorded.
        So the strokes may differ from the true ones in single pixels; the last frame has the
        recorded picture.
        """
        turtles = self._arena.turtles
        for _ in range(self._trace.ticks):
            poses = {name: Pose._make(row[:5]) for name, row in sorted(self._begin_tick().items())}
            for name, (x, y, theta, *_) in poses.items():
                if name in turtles:
                    turtles[name].go_to(x, y, theta, self._arena.canvas)
                else:
                    self._arena.spawn(x, y, theta, name)
            self._record(poses)
        self._end()

    def _begin_tick(self) -> Mapping[str, list[float]]:
        """Apply the inputs of the next tick; return the rows of the recording."""
        self._frame += 1
        for event in self._inputs[self._frame]:
            with suppress(ValueError):  # refused then, too
                apply(self._arena, event)
        return self._rows.get(self._frame, {})

    def _record(self, poses: Mapping[str, Pose]) -> None:
        self.animation.background(self._frame, self._arena.background)
        for name, pose in poses.items():
            turtle = self._arena.turtles[name]
            self.animation.turtle(self._frame, name, pose, turtle)

    def _end(self) -> None:
        """Replace the drawing in the last frame by the recorded picture."""
        self.animation.wipe(self._frame)
        canvas = self._trace.canvas
        packed = canvas.astype(np.int64) @ np.array([1 << 16, 1 << 8, 1, 0])
        packed[canvas[..., 3] == 0] = -1
        for row, values in enumerate(packed):
            edges = [0, *(np.flatnonzero(np.diff(values)) + 1).tolist(), len(values)]
            for first, after in pairwise(edges):
                color = int(values[first])
                if color >= 0:
                    rgb = (color >> 16, color >> 8 & 255, color & 255)
                    self.animation.stroke(self._frame, rgb, [(row, first, after - 1)])

    def _on_stroke(self, pen: Pen, runs: Sequence[Span]) -> None:
        self.animation.stroke(self._frame, (pen.r, pen.g, pen.b), runs)

    def _on_notice(self, notice: Notice) -> None:
        if isinstance(notice, Clear | Reset):
            self.animation.wipe(self._frame)


def _pose(turtle: Turtle) -> Pose:
    """Return the pose that a turtle would publish before its first update."""
    return Pose(turtle.x_m, SIZE_M - turtle.y_down_m, turtle.heading_rad, 0.0, 0.0)


def _is_same(recorded: Sequence[float], now: Sequence[float]) -> bool:
    return all(a == b or (a != a and b != b) for a, b in zip(recorded, now, strict=True))


@dataclass
class _TurtleFrames:
    """One turtle, frame by frame; there may be gaps."""

    stretches: list[list[int]] = field(default_factory=list)
    places: list[Place] = field(default_factory=list)
    poses: list[Pose] = field(default_factory=list)
    pens: list[list[int]] = field(default_factory=list)


class Animation:
    """Records the drawing events of a run, frame by frame, and writes them as JSON."""

    def __init__(self) -> None:
        self._parts: dict[str, _TurtleFrames] = {}
        self._backgrounds: list[list[Any]] = []
        self._colors: dict[Color, int] = {}
        self._ops: list[list[int]] = []
        self._runs: list[int] = []
        # the number of each pixel's colour, from 1; a run of pixels that changes none is left out
        self._paint: npt.NDArray[np.int32] = np.zeros((SIZE_PX, SIZE_PX), np.int32)

    def stroke(self, frame: int, color: Color, runs: Iterable[Span]) -> None:
        """Paint runs of pixels: row, first and last column."""
        number = self._colors.setdefault(color, len(self._colors))
        changed = 0
        for row, first, last in runs:
            pixels = self._paint[row, first : last + 1]
            if (pixels != number + 1).any():
                pixels[:] = number + 1
                self._runs += (row, first, last)
                changed += 1
        if self._ops and self._ops[-1][:2] == [frame, number]:
            self._ops[-1][2] += changed
        elif changed:
            self._ops.append([frame, number, changed])

    def wipe(self, frame: int) -> None:
        self._paint[:] = 0
        self._ops.append([frame, WIPED, 0])

    def background(self, frame: int, color: Sequence[int]) -> None:
        """Set the colour that shows where there is no paint."""
        if not self._backgrounds or self._backgrounds[-1][1] != list(color):
            self._backgrounds.append([frame, list(color)])

    def turtle(self, frame: int, name: str, pose: Pose, turtle: Turtle) -> None:
        part = self._parts.setdefault(name, _TurtleFrames())
        if part.stretches and part.stretches[-1][1] == frame - 1:
            part.stretches[-1][1] = frame
        else:
            part.stretches.append([frame, frame])
        place = turtle.x_m * METER_PX, turtle.y_down_m * METER_PX, turtle.heading_rad
        part.places.append(place)
        part.poses.append(pose)
        pen = turtle.pen
        now = [pen.r, pen.g, pen.b, pen.width, int(not turtle.pen_on)]
        if not part.pens or part.pens[-1][1:] != now:
            part.pens.append([frame, *now])

    def to_json(self, last: int) -> dict[str, Any]:
        """Return all frames up to `last`, as `page/animation.js` reads them."""
        return {
            "last": last,
            "colors": [list(color) for color in self._colors],
            "ops": [number for op in self._ops for number in op],
            "runs": _packed(self._runs, "<u2"),
            "backgrounds": self._backgrounds,
            "turtles": [
                {
                    "name": name,
                    "stretches": part.stretches,
                    "places": _packed(part.places, "<f8"),
                    "poses": _packed(part.poses, "<f4"),
                    "pens": part.pens,
                }
                # the later in the order of their names lie on top
                for name, part in sorted(self._parts.items())
            ],
        }


def _packed(numbers: Sequence[Any], kind: str) -> str:
    with np.errstate(over="ignore"):  # what is beyond a single is infinite there
        return base64.b64encode(np.array(numbers, dtype=kind).tobytes()).decode()
