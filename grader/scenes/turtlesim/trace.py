"""The trace of a run of turtlesim: trajectories, inputs, log, and the drawing.

A recording may come from anywhere. Poses and velocities may be any number or NaN, because a
student's node may send them; ticks, pens, names and pictures are checked.
"""

from __future__ import annotations

import hashlib
import json
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import numpy as np

from grader.recording.subject import OneTrace, Pixels, Start
from turtlesim_py.world import events as inputs
from turtlesim_py.world.arena import TICK_NS
from turtlesim_py.world.events import (
    Cancel,
    CmdVel,
    Event,
    RotateAbsolute,
    SetParameter,
    SetPen,
    SomeEvent,
)
from turtlesim_py.world.stroke import SIZE_PX
from turtlesim_py.world.trajectory import Trajectory
from turtlesim_py.world.turtle import SIZE_M

Value = TypeVar("Value", int, str)
#: The turtle that exercises are about.
FIRST_TURTLE = "turtle1"
#: Where a run begins that is given no start: the middle of the window, heading right.
USUAL_START = Start(SIZE_M / 2, SIZE_M / 2, 0.0)
#: The picture of every turtle in a graded run.
SPRITE = "rolling"


class Log(NamedTuple):
    """A line that the simulator logged."""

    tick: int
    severity: str
    name: str
    text: str


@dataclass(frozen=True, eq=False)
class TurtleTrace(OneTrace):
    """A recorded run of turtlesim.

    Attributes:
        ticks: the number of recorded ticks, of 16 ms each.
        events: every input to the arena, in the order in which they came.
        trajectories: turtle -> what it published, in the order of their appearance.
        logs: the simulator's log.
        canvas: the drawn path at the end, uint8 array (500, 500, 4), alpha 0 where unpainted.
        window: path, background and turtles at the end, uint8 array (500, 500, 3).
    """

    ticks: int
    events: tuple[Event, ...]
    trajectories: Mapping[str, Trajectory]
    logs: tuple[Log, ...]
    canvas: Pixels
    window: Pixels

    @property
    def duration_ns(self) -> int:
        return self.ticks * TICK_NS

    def of_kind(self, kind: type[SomeEvent], turtle: str = FIRST_TURTLE) -> list[SomeEvent]:
        """Return the inputs of one kind, in order; of a kind that names a turtle, those to it."""
        found = (event for event in self.events if isinstance(event, kind))
        return [event for event in found if getattr(event, "turtle", turtle) == turtle]

    def by_tick(self) -> Mapping[int, list[Event]]:
        """Return the inputs of each tick, in order; none for a tick without."""
        found: dict[int, list[Event]] = defaultdict(list)
        for event in self.events:
            found[event.tick].append(event)
        return found

    def trajectory(self, turtle: str = FIRST_TURTLE) -> Trajectory:
        """Return what a turtle published; empty where there was none of that name."""
        empty = Trajectory.of_rows(np.zeros((0, 9)))
        return self.trajectories.get(turtle, empty)

    def sha256(self) -> str:
        """Hash every pose and every input; equal hashes mean equal runs."""
        digest = hashlib.sha256()
        for name in sorted(self.trajectories):
            digest.update(name.encode("utf-8", "surrogatepass"))
            digest.update(self.trajectories[name].rows().tobytes())
        digest.update(json.dumps([inputs.to_json(event) for event in self.events]).encode())
        return digest.hexdigest()


def stands_still(command: CmdVel) -> bool:
    return not command.linear[0] and not command.angular[2]


def check(trace: TurtleTrace) -> None:
    """Refuse a trace that no recorder writes."""
    for event in trace.events:
        _check_event(event, trace.ticks)
    for name, way in trace.trajectories.items():
        at = way.ticks
        if len(at) and (at[0] < 1 or at[-1] > trace.ticks or (np.diff(at) <= 0).any()):
            raise ValueError(f"the ticks of {name!r:.40} are not in order, or not of this run")
    for log in trace.logs:
        _check_tick("a log line", log.tick, trace.ticks)
    for name, pixels, channels in (("path", trace.canvas, 4), ("window", trace.window, 3)):
        height, width = trace.canvas.shape[:2]
        right = (height, width, channels)
        if pixels.shape != right or pixels.dtype != np.uint8 or max(height, width) > SIZE_PX:
            raise ValueError(f"the picture {name} is {pixels.dtype} of the shape {pixels.shape}")


def _check_event(event: Event, ticks: int) -> None:
    _check_tick(event.op, event.tick, ticks)
    if isinstance(event, SetPen):
        for name in ("r", "g", "b", "width", "off"):
            if not 0 <= getattr(event, name) <= 255:
                raise ValueError(f"set_pen: {name} is {getattr(event, name)!r:.40}")
    if isinstance(event, SetParameter) and not isinstance(event.value, bool | int | float | str):
        raise ValueError(f"param: a value is a {type(event.value).__name__}")
    if isinstance(event, RotateAbsolute | Cancel) and not isinstance(event.id, str | int | float):
        raise ValueError(f"{event.op}: an id is a {type(event.id).__name__}")


def _check_tick(what: str, tick: int, ticks: int) -> None:
    # inputs after the last tick have the number of the next one
    if not 0 <= tick <= ticks + 1:
        raise ValueError(f"{what} at tick {tick!r:.40} of {ticks}")
