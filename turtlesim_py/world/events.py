"""What an arena tells its listeners while it works."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

Severity = Literal["INFO", "WARN", "ERROR"]
GoalStatus = Literal["SUCCEEDED", "CANCELED", "ABORTED"]


@dataclass(frozen=True, slots=True)
class LogLine:
    """A line that the original writes to its log."""

    severity: Severity
    text: str


@dataclass(frozen=True, slots=True)
class Input:
    """Something that came in from outside, before it has any effect.

    `op` and the names in `args` are those of a scenario event (see `turtlesim_py.scenario`), so
    that the inputs of any run can be replayed as a scenario.
    """

    op: str
    args: dict[str, Any] = field(default_factory=dict)


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


Event = LogLine | Input | GoalFeedback | GoalResult
