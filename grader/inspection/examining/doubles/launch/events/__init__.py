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


def matches_action(action: Any) -> Any:
    return lambda other: other is action


class _OfProcess:
    def __init__(self, **kwargs: Any) -> None:
        pass


class EventHandler:
    def __init__(self, *, matcher: Any, entities: Any = None, handle_once: bool = False) -> None:
        self.entities = entities


class OnProcessExit(EventHandler):
    def __init__(
        self, *, target_action: Any = None, on_exit: Any, handle_once: Any = False
    ) -> None:
        super().__init__(matcher=None, entities=on_exit)


class OnProcessStart(EventHandler):
    def __init__(
        self, *, target_action: Any = None, on_start: Any, handle_once: Any = False
    ) -> None:
        super().__init__(matcher=None, entities=on_start)


class OnExecutionComplete(EventHandler):
    def __init__(
        self, *, target_action: Any = None, on_completion: Any, handle_once: Any = False
    ) -> None:
        super().__init__(matcher=None, entities=on_completion)


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
        super().__init__(matcher=None)


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
    "Shutdown",
    "matches_action",
    "process",
]
__getattr__ = unknown("launch.events")
