"""A double of ROS's `launch.events`."""

from __future__ import annotations

from typing import Any

from launch._core import unknown


class Event:
    name = "launch.Event"


class Shutdown(Event):
    def __init__(self, *, reason: str = "reason not given", due_to_sigint: bool = False) -> None:
        self.reason = reason


def matches_action(action: Any) -> Any:
    return lambda other: other is action


from launch.events import process  # noqa: E402

__all__ = [
    "Event",
    "Shutdown",
    "matches_action",
    "process",
]
__getattr__ = unknown("launch.events")
