"""A double of ROS's `launch.events`, `launch.events.process` and `launch.event_handlers`.

Launch files name these; none ever happens, and what would start then is taken down now.
"""

from __future__ import annotations

from typing import Any

from launch._core import module, unknown


class Event:
    name = "launch.Event"


class Shutdown(Event):
    def __init__(self, *, reason: str = "reason not given", due_to_sigint: bool = False) -> None:
        self.reason = reason


class Happened:
    """An event of which nothing is known: whatever it has is a text."""

    def __getattr__(self, name: str) -> Any:
        return self

    def __str__(self) -> str:
        return "?"


def matches_action(action: Any) -> Any:
    return lambda other: other is action


class _OfProcess:
    def __init__(self, **kwargs: Any) -> None:
        pass


class EventHandler:
    #: what a process does: `start` or `exit`; '' for all else, of which nobody knows when it is
    on = ""

    def __init__(
        self, *, matcher: Any, entities: Any = None, handle_once: Any = False, target: Any = None
    ) -> None:
        self.entities, self.target = entities, target


class OnProcessExit(EventHandler):
    on = "exit"

    def __init__(self, *, target_action: Any = None, on_exit: Any, **more: Any) -> None:
        super().__init__(matcher=None, entities=on_exit, target=target_action, **more)


class OnProcessStart(EventHandler):
    on = "start"

    def __init__(self, *, target_action: Any = None, on_start: Any, **more: Any) -> None:
        super().__init__(matcher=None, entities=on_start, target=target_action, **more)


class OnExecutionComplete(EventHandler):
    on = "exit"

    def __init__(self, *, target_action: Any = None, on_completion: Any, **more: Any) -> None:
        super().__init__(matcher=None, entities=on_completion, target=target_action, **more)


class OnShutdown(EventHandler):
    def __init__(self, *, on_shutdown: Any, handle_once: Any = False) -> None:
        super().__init__(matcher=None, entities=on_shutdown)


class OnProcessIO(EventHandler):
    def __init__(
        self,
        *,
        target_action: Any = None,
        on_stdin: Any = None,
        on_stdout: Any = None,
        on_stderr: Any = None,
        handle_once: Any = False,
    ) -> None:
        super().__init__(matcher=None, entities=on_stdin or on_stdout or on_stderr)


process = module(
    "launch.events.process",
    *(
        type(name, (_OfProcess,), {})
        for name in (
            "ProcessExited",
            "ProcessIO",
            "ProcessStarted",
            "ShutdownProcess",
            "SignalProcess",
        )
    ),
)
event_handlers = module(
    "launch.event_handlers",
    EventHandler,
    OnExecutionComplete,
    OnProcessExit,
    OnProcessIO,
    OnProcessStart,
    OnShutdown,
)

__all__ = [
    "Event",
    "Happened",
    "Shutdown",
    "matches_action",
    "process",
]
__getattr__ = unknown("launch.events")
