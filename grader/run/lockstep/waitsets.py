"""rclpy's wait sets, timers, clocks, guards, events: they read our readers, in virtual time.

Used by both sides of the link; the simulator never waits.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable, Sequence
from typing import Any

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

from grader.run.lockstep.faults import pass_on
from grader.run.lockstep.matching import Endpoint, Reader
from grader.run.lockstep.protocol import BOOT_NS, EPOCH_NS, NEVER

_Timer, _EventHandle, _Clock = _rclpy.Timer, _rclpy.EventHandle, _rclpy.Clock


class Waiter:
    """How a process waits. This base class never waits: the simulator's wait sets only poll."""

    def __init__(self, now_ns: Callable[[], int]) -> None:
        """`now_ns` returns the time from the start of the run [ns]."""
        self.now_ns = now_ns
        self._clocks: list[weakref.ref[Clock]] = []

    def attach_clock(self, clock: Clock) -> None:
        """Have the clock of a timer move with the time from now on."""
        if not clock.is_attached:
            clock.is_attached = True
            self._clocks.append(weakref.ref(clock, self._clocks.remove))
            clock.set_now(self.now_ns())

    def set_now(self, now_ns: int) -> None:
        """Move the attached clocks to this time."""
        for reference in self._clocks:
            clock = reference()
            if clock is not None:
                clock.set_now(now_ns)

    def asked_ns(self) -> int:
        """Return the time for a clock that is asked for it [ns]."""
        return self.now_ns()

    def before_wait(self) -> None:
        """Called before a wait set checks whether something is ready."""

    def before_events(self) -> None:
        """Called before a wait set checks whether there are events."""

    def found_work(self) -> None:
        """Called when a wait set has found something to do."""

    def found_nothing(self) -> None:
        """Called when a wait set that must not wait has found nothing."""

    def wait_for(self, wait_set: WaitSet, deadline_ns: int) -> None:
        """Wait until something may be ready."""
        raise AssertionError("the simulator never waits for its node")

    def deadline(self, timeout_ns: int) -> int:
        """Return when a time-out from now ends; a negative one never does."""
        return NEVER if timeout_ns < 0 else min(NEVER, self.now_ns() + timeout_ns)

    def poke(self, cause: object) -> None:
        """Called when something that a wait set may hold has changed."""


WAITER: Waiter


def install(waiter: Waiter) -> None:
    """Put the classes of this module into rclpy's extension module."""
    global WAITER
    WAITER = waiter
    for kind in (WaitSet, GuardCondition, Timer, Clock, EventHandle):
        setattr(_rclpy, kind.__name__, kind)


class GuardCondition(_rclpy.GuardCondition):
    """A flag; rcl's own is never waited for."""

    is_triggered = False

    def trigger_guard_condition(self) -> None:
        self.is_triggered = True
        WAITER.poke(self)


class Clock(_rclpy.Clock):
    """A clock of any type: underneath, a ROS clock whose time is set by us."""

    def __init__(self, kind: int) -> None:
        kinds = _rclpy.ClockType
        _Clock.__init__(self, int(kinds.ROS_TIME))
        _Clock.set_ros_time_override_is_enabled(self, True)
        self.kind = kinds(int(kind))
        self.offset_ns = BOOT_NS if self.kind == kinds.STEADY_TIME else EPOCH_NS
        self.is_attached = False
        # use_sim_time: then the time is what comes on /clock
        self.is_overridden = False
        self.override_ns = 0

    def set_now(self, now_ns: int) -> None:
        if not self.is_overridden:
            self._set(self.offset_ns + now_ns)

    def _set(self, time_ns: int) -> None:
        point = _rclpy.rcl_time_point_t(time_ns, int(_rclpy.ClockType.ROS_TIME))
        _Clock.set_ros_time_override(self, point)

    def get_now(self) -> Any:
        time_ns = self.offset_ns + WAITER.asked_ns()
        shown_ns = self.override_ns if self.is_overridden else time_ns
        return _rclpy.rcl_time_point_t(shown_ns, int(self.kind))

    def get_ros_time_override_is_enabled(self) -> bool:
        return self.is_overridden

    def set_ros_time_override_is_enabled(self, enabled: bool) -> None:
        self.is_overridden = enabled
        self._set(self.override_ns if enabled else self.offset_ns + WAITER.now_ns())

    def set_ros_time_override(self, time_point: Any) -> None:
        self.override_ns = time_point.nanoseconds
        if self.is_overridden:
            self._set(self.override_ns)

    def add_clock_callback(self, *_: object) -> None:
        """Our clocks jump at every tick, where real ones flow."""

    def remove_clock_callback(self, *_: object) -> None:
        """Nothing was added."""


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
        readers: those of its entities, and of actions.
    """

    def __init__(self, *_: Any) -> None:
        self.clear_entities()

    def clear_entities(self) -> None:
        self.readers: list[Reader] = []
        self._guards: list[GuardCondition] = []
        self._timers: list[Timer] = []
        self._events: list[EventHandle] = []
        self._readers: list[tuple[Any, Reader]] = []
        self._kinds: dict[Any, str] = {}
        #: what was ready after `wait`: entities with readers and timers
        self._ready: list[Any] = []
        self._ready_guards: list[GuardCondition] = []
        self._ready_events: list[bool] = []
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
        self._guards.append(handle)
        return len(self._guards) - 1

    def add_timer(self, handle: Any) -> int:
        self._timers.append(handle)
        self._kinds[handle] = "timer"
        return len(self._timers) - 1

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
            return [guard.pointer for guard in self._ready_guards]
        return [handle.pointer for handle in self._ready if self._kinds[handle] == kind]

    def is_ready(self, kind: str, index: int) -> bool:
        """Whether an event was ready after `wait`; rclpy asks by index for nothing else."""
        return kind == "event" and self._ready_events[index]

    def _collect(self) -> bool:
        """Find what is ready; return whether anything is."""
        self._ready = [handle for handle, reader in self._readers if reader.items]
        self._ready += [each for each in self._timers if not each.is_gone and each.is_timer_ready()]
        self._ready_guards = [guard for guard in self._guards if guard.is_triggered]
        for guard in self._ready_guards:
            guard.is_triggered = False
        if self._events:
            WAITER.before_events()
        self._ready_events = [event.is_due() for event in self._events]
        self._has_work = (
            bool(self._ready)
            or True in self._ready_events
            # those of actions
            or (len(self.readers) > len(self._readers) and any(i.items for i in self.readers))
        )
        return self._has_work or bool(self._ready_guards)

    def _next_timer(self) -> int:
        """Return when the first timer is due."""
        now_ns = WAITER.deadline(0)
        left_ns = (each.time_until_next_call() for each in self._timers if not each.is_gone)
        return min((now_ns + max(0, left) for left in left_ns if left is not None), default=NEVER)
