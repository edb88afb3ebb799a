"""What an arena tells its listeners while it works: inputs, log lines, how goals go."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from turtlesim_py.world.events import Event

Severity = Literal["INFO", "WARN", "ERROR"]
GoalStatus = Literal["SUCCEEDED", "CANCELED", "ABORTED"]


@dataclass(frozen=True, slots=True)
class LogLine:
    """A line that the original writes to its log."""

    severity: Severity
    text: str


@dataclass(frozen=True, slots=True)
class GoalFeedback:
    """A rotation goal still has `remaining_rad` to turn."""

    turtle: str
    goal_id: object
    remaining_rad: float


@dataclass(frozen=True, slots=True)
class GoalResult:
    """A rotation goal ended; `delta_rad` is start minus end, the original's sign."""

    turtle: str
    goal_id: object
    status: GoalStatus
    delta_rad: float


#: An event is told before it has any effect.
Notice = Event | LogLine | GoalFeedback | GoalResult
