"""rclpy's wait sets, timers, guards, events: they read our readers, and wait in virtual time.

Used by both sides of the link; the simulator never waits.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

from grader.run.lockstep.faults import pass_on
from grader.run.lockstep.protocol import NEVER
from grader.run.lockstep.registry import Endpoint, Reader

_Timer, _EventHandle = _rclpy.Timer, _rclpy.EventHandle


class Waiter:
    """How a process waits. This base class never waits: the simulator's wait sets only poll."""

    def __init__(self, attach_clock: Callable[[Any], None]) -> None:
        """`attach_clock` is called with the clock of each timer."""
        self.attach_clock = attach_clock

    @property
    def graph_epoch(self) -> int:
        """The number of changes of the graph: after one, there may be events."""
        return -1

    @property
    def is_alone(self) -> bool:
        """Whether the program has but one thread."""
        return True

    def before_wait(self) -> None:
        """Called before a wait set checks whether something is ready."""

    def found_work(self) -> None:
        """Called when a wait set has found something to do."""

    def found_nothing(self) -> None:
        """Called when a wait set that must not wait has found nothing."""

    def wait_for(self, wait_set: WaitSet, deadline_ns: int) -> None:
        """Wait until something may be ready."""
        raise AssertionError("the simulator never waits for its node")

    def deadline(self, timeout_ns: int) -> int:
        """Return when a time-out from now ends."""
        return 0

    def poke(self, cause: object) -> None:
        """Called when something that a wait set may hold has changed."""


WAITER: Waiter


def install(waiter: Waiter) -> None:
    """Put the classes of this module into rclpy's extension module."""
    global WAITER
    WAITER = waiter
    for kind in (WaitSet, GuardCondition, Timer, EventHandle):
        setattr(_rclpy, kind.__name__, kind)


class GuardCondition(_rclpy.GuardCondition):
    """A flag; rcl's own is never waited for."""

    is_triggered = False

    def trigger_guard_condition(self) -> None:
        self.is_triggered = True
        WAITER.poke(self)


class Timer(_rclpy.Timer):
    """A timer whose changes wake those who wait for it."""

    #: it is to be destroyed
    is_gone = False

    def destroy_when_not_in_use(self) -> None:
        self.is_gone = True
        _Timer.destroy_when_not_in_use(self)

    def __init__(self, clock: Any, *args: Any) -> None:
        WAITER.attach_clock(clock)  # first: from this time the period counts
        pass_on(_Timer.__init__, self, clock, *args)

    def reset_timer(self) -> None:
        _Timer.reset_timer(self)
        WAITER.poke(self)

    def cancel_timer(self) -> None:
        _Timer.cancel_timer(self)
        WAITER.poke(self)

    def change_timer_period(self, period_ns: int) -> None:
        pass_on(_Timer.change_timer_period, self, period_ns)
        WAITER.poke(self)


class MatchedStatus(_rclpy.rmw_matched_status_t):
    """How many counterparts there are; rclpy's own cannot be set."""

    total_count = 0
    total_count_change = 0
    current_count = 0
    current_count_change = 0


class UnfitStatus(_rclpy.rmw_requested_qos_incompatible_event_status_t):
    """How many there have been whose quality of service does not fit, and why the last did not."""

    total_count = 0
    total_count_change = 0
    last_policy_kind = 0


class EventHandle(_rclpy.EventHandle):
    """An event: counterparts have come or gone, or their quality of service does not fit.

    We know them as soon as they are there. Other events are about real time or real networks, and
    never come.
    """

    #: it is to be destroyed
    is_gone = False

    def __init__(self, parent: Any, kind: Any) -> None:
        pass_on(_EventHandle.__init__, self, parent, kind)
        self._endpoint: Endpoint = parent.endpoints[0]
        self._counts_matches = kind.name.endswith("_MATCHED")
        self._counts_unfit = bool(kind.name.endswith("_INCOMPATIBLE_QOS"))
        #: how many there had been and were at the last report to the program
        self._reported = (0, 0)

    def destroy_when_not_in_use(self) -> None:
        """As in rclpy; a wait set may still hold it."""
        self.is_gone = True
        _EventHandle.destroy_when_not_in_use(self)

    def is_due(self) -> bool:
        """Whether there is something to report."""
        return not self.is_gone and self._counted() != self._reported

    def _counted(self) -> tuple[int, int]:
        if self._counts_matches:
            return self._endpoint.matches, self._endpoint.matched
        return (self._endpoint.unfit, 0) if self._counts_unfit else (0, 0)

    def take_event(self) -> Any:
        before, self._reported = self._reported, self._counted()
        status: Any
        if self._counts_matches:
            status = MatchedStatus.__new__(MatchedStatus)
            status.current_count = self._reported[1]
            status.current_count_change = self._reported[1] - before[1]
        elif self._counts_unfit:
            status = UnfitStatus.__new__(UnfitStatus)
            status.last_policy_kind = int(self._endpoint.policy)
        else:
            return pass_on(_EventHandle.take_event, self)
        status.total_count = self._reported[0]
        status.total_count_change = self._reported[0] - before[0]
        return status


class WaitSet:
    """As `_rclpy.WaitSet`, in Python.

    Attributes:
        end_ns: when the waiting executor's time is out; this works like a timer.
        is_out: whether the time was out after `wait`.
        ready: the handles of all that was ready after `wait`, but guard conditions and events.
        ready_guards: the guard conditions that were triggered.
    """

    def __init__(self, *_: Any) -> None:
        self.clear_entities()

    def clear_entities(self) -> None:
        self.readers: list[Reader] = []
        self.guards: list[GuardCondition] = []
        self.timers: list[Timer] = []
        self.end_ns = NEVER
        self.is_out = False
        self.ready_guards: list[GuardCondition] = []
        self._events: list[EventHandle] = []
        self._readers: list[tuple[Any, Reader]] = []
        self._kinds: dict[Any, str] = {}
        self.ready: list[Any] = []
        self._ready_events: list[bool] = []
        self._quiet_epoch = -1
        self._has_work = False

    def _add(self, kind: str, handle: Any) -> int:
        reader = getattr(handle, "reader", None)
        if reader is not None:  # else made by rclpy in C++: ~/get_type_description
            self.readers.append(reader)
            self._readers.append((handle, reader))
            self._kinds[handle] = kind
        return len(self._readers)

    def add_subscription(self, handle: Any) -> int:
        return self._add("subscription", handle)

    def add_client(self, handle: Any) -> int:
        return self._add("client", handle)

    def add_service(self, handle: Any) -> int:
        return self._add("service", handle)

    def add_guard_condition(self, handle: Any) -> int:
        self.guards.append(handle)
        return len(self.guards) - 1

    def add_timer(self, handle: Any) -> int:
        self.timers.append(handle)
        self._kinds[handle] = "timer"
        return len(self.timers) - 1

    def add_event(self, handle: Any) -> int:
        self._events.append(handle)
        return len(self._events) - 1

    def add_readers(self, readers: Sequence[Reader]) -> None:
        """Add the readers of an action."""
        self.readers.extend(readers)

    def wait(self, timeout_ns: int) -> None:
        """Wait until something is ready or the time is out (negative: never)."""
        WAITER.before_wait()
        deadline_ns = WAITER.deadline(timeout_ns)
        while not self._collect():
            if timeout_ns == 0:
                break
            WAITER.wait_for(self, min(deadline_ns, self._next_timer()))
            if WAITER.deadline(0) >= deadline_ns:
                self._collect()
                break
        if self._has_work:
            WAITER.found_work()
        elif timeout_ns == 0:
            # What comes meanwhile is for the next poll. A guard condition is no work: each
            # rclpy.spin_once triggers one, and a loop of them would never cost anything.
            WAITER.found_nothing()

    def get_ready_entities(self, kind: str) -> list[int]:
        """Return the addresses of what was ready after `wait`."""
        if kind == "guard_condition":
            return [guard.pointer for guard in self.ready_guards]
        return [handle.pointer for handle in self.ready if self._kinds[handle] == kind]

    def is_ready(self, kind: str, index: int) -> bool:
        """Whether an event was ready after `wait`; rclpy asks by index for nothing else."""
        return kind == "event" and index < len(self._ready_events) and self._ready_events[index]

    def has_events(self) -> bool:
        """Whether any event was ready after `wait`."""
        return any(self._ready_events)

    def _collect(self) -> bool:
        ready = self.ready = []
        for handle, reader in self._readers:
            if reader.items:
                ready.append(handle)
        for timer in self.timers:
            if not timer.is_gone and timer.is_timer_ready():
                ready.append(timer)
        guards = self.ready_guards = []
        for guard in self.guards:
            if guard.is_triggered:
                guard.is_triggered = False
                guards.append(guard)
        self._ready_events = self._ask_for_events() if self._events else []
        self.is_out = self.end_ns < NEVER and WAITER.deadline(0) >= self.end_ns
        self._has_work = (
            bool(ready)
            or self.is_out
            or True in self._ready_events
            # those of actions
            or (len(self.readers) > len(self._readers) and any(i.items for i in self.readers))
        )
        return self._has_work or bool(guards)

    def _ask_for_events(self) -> list[bool]:
        """Return for each event whether it is due; empty where none is."""
        epoch = WAITER.graph_epoch
        if self._quiet_epoch == epoch:
            return []
        due = [event.is_due() for event in self._events]
        if not any(due):
            self._quiet_epoch = epoch
            return []
        return due

    def _next_timer(self) -> int:
        """Return when the first timer is due."""
        first_ns = self.end_ns
        now_ns = WAITER.deadline(0)
        for timer in self.timers:
            if not timer.is_gone and (left_ns := timer.time_until_next_call()) is not None:
                first_ns = min(first_ns, now_ns + max(0, left_ns))
        return first_ns
