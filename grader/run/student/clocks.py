"""Time, as this process sees it: `time`, `datetime`, rclpy's clocks."""

from __future__ import annotations

import datetime as _datetime
import queue
import sched
import threading
import time
import weakref
from collections.abc import Callable
from typing import Any

from grader.run.lockstep import real
from grader.run.student.scheduler import Scheduler

SCHEDULER: Scheduler
#: The run starts on 15 June 2025 at 15:06:40 UTC, 1000 s after the machine did.
EPOCH_NS = 1_750_000_000 * 10**9
BOOT_NS = 1000 * 10**9


def install(scheduler: Scheduler) -> None:
    """Replace the clocks of the standard library in this interpreter."""
    global SCHEDULER
    SCHEDULER = scheduler
    time.sleep = _sleep
    time.time, time.time_ns = _seconds(EPOCH_NS), _nanoseconds(EPOCH_NS)
    time.monotonic, time.monotonic_ns = _seconds(BOOT_NS), _nanoseconds(BOOT_NS)
    time.perf_counter, time.perf_counter_ns = time.monotonic, time.monotonic_ns
    time.clock_gettime_ns = _clock_gettime_ns
    time.clock_gettime = lambda clk_id: _clock_gettime_ns(clk_id) / 1e9
    time.localtime = lambda seconds=None: real.localtime(_or_now(seconds))
    time.gmtime = lambda seconds=None: real.gmtime(_or_now(seconds))
    time.ctime = lambda seconds=None: real.ctime(_or_now(seconds))
    time.strftime = lambda form, when=None: real.strftime(form, when or time.localtime())
    # these have imported the names
    threading._time = queue.time = sched._time = time.monotonic  # type: ignore[attr-defined]
    _datetime.datetime = _VirtualDatetime  # type: ignore[misc]
    _datetime.date = _VirtualDate  # type: ignore[misc]


def _sleep(seconds: Any) -> None:
    if seconds < 0:
        raise ValueError("sleep length must be non-negative")
    SCHEDULER.sleep(int(seconds * 1e9))


def _seconds(offset_ns: int) -> Callable[[], float]:
    def now() -> float:
        SCHEDULER.charge()
        return (offset_ns + SCHEDULER.now_ns) / 1e9

    return now


def _nanoseconds(offset_ns: int) -> Callable[[], int]:
    def now_ns() -> int:
        SCHEDULER.charge()
        return offset_ns + SCHEDULER.now_ns

    return now_ns


def _clock_gettime_ns(clk_id: int) -> int:
    if clk_id in (time.CLOCK_REALTIME, time.CLOCK_TAI):
        return time.time_ns()
    if clk_id in (time.CLOCK_MONOTONIC, time.CLOCK_MONOTONIC_RAW, time.CLOCK_BOOTTIME):
        return time.monotonic_ns()
    return real.clock_gettime_ns(clk_id)  # processor time stays real


def _or_now(seconds: Any) -> float:
    return time.time() if seconds is None else float(seconds)


class _LikeOriginal(type):
    """Objects of the C class count as instances: arithmetic on ours makes those."""

    def __instancecheck__(cls, instance: object) -> bool:
        return cls.__subclasscheck__(type(instance))

    def __subclasscheck__(cls, subclass: type) -> bool:
        original = cls.__dict__.get("ORIGINAL")  # not that of a base: a student may derive too
        return issubclass(subclass, original) if original else super().__subclasscheck__(subclass)


class _VirtualDatetime(_datetime.datetime, metaclass=_LikeOriginal):
    """As `datetime.datetime`, which asks the real clock in C."""

    ORIGINAL = _datetime.datetime

    @classmethod
    def now(cls, tz: Any = None) -> _datetime.datetime:  # type: ignore[override]
        """The time now."""
        return cls.fromtimestamp(time.time(), tz)

    today = now  # type: ignore[assignment]

    @classmethod
    def utcnow(cls) -> _datetime.datetime:  # type: ignore[override]
        """The time now in UTC."""
        utc = cls.fromtimestamp(time.time(), _datetime.UTC)
        return utc.replace(tzinfo=None)


class _VirtualDate(_datetime.date, metaclass=_LikeOriginal):
    """As `datetime.date`."""

    ORIGINAL = _datetime.date

    @classmethod
    def today(cls) -> _datetime.date:  # type: ignore[override]
        """The date now."""
        return cls.fromtimestamp(time.time())


_VirtualDatetime.__name__ = _VirtualDatetime.__qualname__ = "datetime"
_VirtualDate.__name__ = _VirtualDate.__qualname__ = "date"
for _class in (_VirtualDatetime, _VirtualDate):
    _class.__module__ = "datetime"


def install_in_rclpy(rclpy: Any, now_ns: Callable[[], int], charge: Callable[[], None]) -> Clocks:
    """Replace rclpy's clocks; whoever owns the time calls `Clocks.set_now` when it moves."""
    clocks = Clocks(now_ns)
    rclpy.Clock = _clock_class(rclpy, clocks, charge)
    return clocks


class Clocks:
    """rclpy's clocks in this process. Only those that timers hang on are told the time."""

    def __init__(self, now_ns: Callable[[], int]) -> None:
        self.now_ns = now_ns
        self._told: list[weakref.ref[Any]] = []

    def tell(self, clock: Any) -> None:
        """From now on this clock is told the time."""
        if not clock.is_told:
            clock.is_told = True
            self._told.append(weakref.ref(clock, self._told.remove))
            clock.tell(self.now_ns())

    def set_now(self, now_ns: int) -> None:
        """The time has moved."""
        for reference in self._told:
            clock = reference()
            if clock is not None:
                clock.tell(now_ns)


def _clock_class(rclpy: Any, clocks: Clocks, charge: Callable[[], None]) -> type:
    base = rclpy.Clock
    kinds, point = rclpy.ClockType, rclpy.rcl_time_point_t

    class VirtualClock(base):  # type: ignore[misc, valid-type]
        """A clock of any type: underneath, a ROS clock whose time is set by us."""

        def __init__(self, kind: int) -> None:
            base.__init__(self, int(kinds.ROS_TIME))
            base.set_ros_time_override_is_enabled(self, True)
            self.kind = kinds(int(kind))
            self.offset_ns = BOOT_NS if self.kind == kinds.STEADY_TIME else EPOCH_NS
            self.is_told = False
            # use_sim_time: then the time is what comes on /clock
            self.is_overridden = False
            self.override_ns = 0

        def tell(self, now_ns: int) -> None:
            if not self.is_overridden:
                self._set(self.offset_ns + now_ns)

        def _set(self, time_ns: int) -> None:
            base.set_ros_time_override(self, point(time_ns, int(kinds.ROS_TIME)))

        def get_now(self) -> Any:
            charge()
            time_ns = self.offset_ns + clocks.now_ns()
            return point(self.override_ns if self.is_overridden else time_ns, int(self.kind))

        def get_ros_time_override_is_enabled(self) -> bool:
            return self.is_overridden

        def set_ros_time_override_is_enabled(self, enabled: bool) -> None:
            self.is_overridden = enabled
            self._set(self.override_ns if enabled else self.offset_ns + clocks.now_ns())

        def set_ros_time_override(self, time_point: Any) -> None:
            self.override_ns = time_point.nanoseconds
            if self.is_overridden:
                self._set(self.override_ns)

        def add_clock_callback(self, *_: object) -> None:
            """Our clocks jump at every tick, where real ones flow."""

        def remove_clock_callback(self, *_: object) -> None:
            """Nothing was added."""

    return VirtualClock


def clock_event_class(scheduler: Scheduler) -> type:
    """What `Clock.sleep_until` waits on."""

    class ClockEvent:
        def __init__(self) -> None:
            self._is_set = False
            self._waiting: Any = None

        def wait_until_steady(self, clock: Any, until: Any) -> None:
            if clock.is_overridden:  # and nobody publishes /clock
                deadline_ns = scheduler.now_ns + 10**18
            else:
                deadline_ns = until.nanoseconds - clock.offset_ns
            self._waiting = scheduler.current
            while not self._is_set and scheduler.now_ns < deadline_ns:
                scheduler.block(deadline_ns)

        wait_until_system = wait_until_ros = wait_until_steady

        def set(self) -> None:
            self._is_set = True
            if self._waiting is not None:
                scheduler.wake(self._waiting)

        def clear(self) -> None:
            self._is_set = False

        def is_set(self) -> bool:
            return self._is_set

    return ClockEvent
