"""A double of ROS's `launch.events`, `launch.events.process` and `launch.event_handlers`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from launch._core import Action, LaunchContext, LaunchDescriptionEntity, module, unknown


class Event:
    name = "launch.Event"
    action: Any = None


class Shutdown(Event):
    def __init__(self, *, reason: str = "reason not given", due_to_sigint: bool = False) -> None:
        self.reason, self.due_to_sigint = reason, due_to_sigint


class ExecutionComplete(Event):
    def __init__(self, *, action: Any) -> None:
        self.action = action


class Happened:
    """An event of which nothing is known: whatever it has is a text."""

    def __getattr__(self, name: str) -> Any:
        return self

    def __str__(self) -> str:
        return "?"


def matches_action(action: Any) -> Any:
    return lambda other: other is action


class RunningProcessEvent(Event):
    """What a process does; one that ends has ended well, as far as a launch file is evaluated."""

    def __init__(self, *, action: Any = None, name: str = "", **more: Any) -> None:
        self.action, self.process_name = action, name
        self.__dict__.update(
            {"cmd": [], "cwd": None, "env": None, "pid": 0, "returncode": 0}, **more
        )


class ProcessStarted(RunningProcessEvent):
    pass


class ProcessExited(RunningProcessEvent):
    pass


class ProcessIO(RunningProcessEvent):
    pass


class BaseEventHandler:
    def __init__(self, *, matcher: Any, entities: Any = None, handle_once: bool = False) -> None:
        self._matcher, self.entities, self.handle_once = matcher, entities, handle_once

    def matches(self, event: Event) -> bool:
        return bool(self._matcher(event))

    def handle(self, event: Any, context: LaunchContext) -> Any:
        """What is done; a function is asked, and so is known only where the event is."""
        return self.entities(event, context) if callable(self.entities) else self.entities


class EventHandler(BaseEventHandler):
    pass


class _OnAction(BaseEventHandler):
    """Handles an event of one action, of those that a function takes, or of all."""

    event: type[Event] = Event

    def __init__(self, target_action: Any, entities: Any, **more: Any) -> None:
        from launch.actions import ExecuteLocal  # it imports this module

        of = Action if self.event is ExecutionComplete else ExecuteLocal
        if not (target_action is None or isinstance(target_action, of) or callable(target_action)):
            raise TypeError(f"action_matcher must be an '{of.__name__}' instance or a callable")
        if isinstance(entities, Iterable):
            for each in entities:
                if not isinstance(each, LaunchDescriptionEntity):
                    raise TypeError(
                        "expected all items in 'on_event' iterable to be of type "
                        f"'LaunchDescriptionEntity' but got '{type(each)}'"
                    )
        super().__init__(matcher=self._is_meant, entities=entities, **more)
        self._target = target_action

    def _is_meant(self, event: Any) -> bool:
        if not isinstance(event, self.event):
            return False
        if callable(self._target):
            return bool(self._target(event.action))
        return self._target is None or self._target is event.action


class OnProcessExit(_OnAction):
    event = ProcessExited

    def __init__(self, *, target_action: Any = None, on_exit: Any, **more: Any) -> None:
        super().__init__(target_action, on_exit, **more)


class OnProcessStart(_OnAction):
    event = ProcessStarted

    def __init__(self, *, target_action: Any = None, on_start: Any, **more: Any) -> None:
        super().__init__(target_action, on_start, **more)


class OnExecutionComplete(_OnAction):
    event = ExecutionComplete

    def __init__(self, *, target_action: Any = None, on_completion: Any, **more: Any) -> None:
        super().__init__(target_action, on_completion, **more)


class OnProcessIO(_OnAction):
    event = ProcessIO

    def __init__(
        self,
        *,
        target_action: Any = None,
        on_stdin: Any = None,
        on_stdout: Any = None,
        on_stderr: Any = None,
        **more: Any,
    ) -> None:
        super().__init__(target_action, on_stdin or on_stdout or on_stderr, **more)


class OnShutdown(BaseEventHandler):
    def __init__(self, *, on_shutdown: Any, **more: Any) -> None:
        super().__init__(
            matcher=lambda event: isinstance(event, Shutdown), entities=on_shutdown, **more
        )


process = module(
    "launch.events.process",
    *(ProcessExited, ProcessIO, ProcessStarted, RunningProcessEvent),
    # what a process is asked to do; nobody does it here
    *(type(name, (RunningProcessEvent,), {}) for name in ("ShutdownProcess", "SignalProcess")),
    matches_action=matches_action,
)
event_handlers = module(
    "launch.event_handlers",
    *(OnExecutionComplete, OnProcessExit, OnProcessIO, OnProcessStart, OnShutdown),
)

__all__ = [
    "Event",
    "ExecutionComplete",
    "Shutdown",
    "matches_action",
    "process",
]
__getattr__ = unknown("launch.events")
