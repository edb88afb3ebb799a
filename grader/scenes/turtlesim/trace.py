"""What a run of turtlesim leaves: where each turtle was, what came in, what the pens drew."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple, Self, TypeVar

import numpy as np
import numpy.typing as npt

from grader.scenes.scene import Trace
from turtlesim_py.world import events as inputs
from turtlesim_py.world.events import Event, SomeEvent
from turtlesim_py.world.trajectory import Trajectory
from turtlesim_py.world.turtle import TICK_S

Pixels = npt.NDArray[np.uint8]
Value = TypeVar("Value", int, str)
#: The turtle that exercises are about.
FIRST_TURTLE = "turtle1"
#: How every turtle of a graded run looks.
SPRITE = "rolling"


class Log(NamedTuple):
    """A line that the simulator logged."""

    tick: int
    severity: str
    name: str
    text: str


@dataclass(frozen=True, eq=False)
class TurtleTrace:
    """A recorded run of turtlesim.

    Attributes:
        ticks: how many were recorded, of 16 ms each.
        events: every input to the arena, in the order in which they came.
        trajectories: turtle -> what it published, in the order in which the turtles appeared.
        logs: what the simulator logged.
        canvas: the drawn path at the end, uint8 array (500, 500, 4), alpha 0 where unpainted.
        window: path, background and turtles at the end, uint8 array (500, 500, 3).
    """

    ticks: int
    events: tuple[Event, ...]
    trajectories: Mapping[str, Trajectory]
    logs: tuple[Log, ...]
    canvas: Pixels
    window: Pixels

    @classmethod
    def of(cls, trace: Trace) -> Self:
        """A recording's trace as what it is.

        Raises:
            TypeError: it is another scene's.
        """
        if not isinstance(trace, cls):
            raise TypeError(f"expected a trace of turtlesim, found a {type(trace).__name__}")
        return trace

    @property
    def simulated_s(self) -> float:
        """How long was recorded [s]."""
        return round(self.ticks * TICK_S, 3)

    def of_kind(self, kind: type[SomeEvent], turtle: str = FIRST_TURTLE) -> list[SomeEvent]:
        """The inputs of one kind, in order; of a kind that names a turtle, those to this one."""
        found = (event for event in self.events if isinstance(event, kind))
        return [event for event in found if getattr(event, "turtle", turtle) == turtle]

    def trajectory(self, turtle: str = FIRST_TURTLE) -> Trajectory:
        """What a turtle published; nothing where there was none of that name."""
        empty = Trajectory.of_rows(np.zeros((0, 9)))
        return self.trajectories.get(turtle, empty)

    def sha256(self) -> str:
        """A hash of every pose and every input; equal hashes mean equal runs."""
        digest = hashlib.sha256()
        for name in sorted(self.trajectories):
            digest.update(name.encode())
            digest.update(self.trajectories[name].rows().tobytes())
        digest.update(json.dumps([inputs.to_json(event) for event in self.events]).encode())
        return digest.hexdigest()
