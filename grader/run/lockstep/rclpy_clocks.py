"""rclpy's clocks, which show virtual time. Used by both sides of the link."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

from grader.run.lockstep.protocol import BOOT_NS, EPOCH_NS


def install(
    now_ns: Callable[[], int],
    charge: Callable[[], None],
    unpaid_ns: Callable[[], int] = lambda: 0,
) -> RclpyClocks:
    """Replace rclpy's clocks; call `RclpyClocks.set_now` whenever the time moves.

    Args:
        charge: called when a clock is asked for the time.
        unpaid_ns: added to the time that a clock returns when it is asked.
    """
    clocks = RclpyClocks(now_ns)
    _rclpy.Clock = _clock_class(clocks, charge, unpaid_ns)
    return clocks


class RclpyClocks:
    """rclpy's clocks in this process. Only the attached ones, which have timers, are updated."""

    def __init__(self, now_ns: Callable[[], int]) -> None:
        self.now_ns = now_ns
        self._attached: list[weakref.ref[Any]] = []

    def attach(self, clock: Any) -> None:
        """Update this clock from now on."""
        if not clock.is_attached:
            clock.is_attached = True
            self._attached.append(weakref.ref(clock, self._attached.remove))
            clock.set_now(self.now_ns())

    def set_now(self, now_ns: int) -> None:
        """Move the attached clocks to this time."""
        for reference in self._attached:
            clock = reference()
            if clock is not None:
                clock.set_now(now_ns)


def _clock_class(
    clocks: RclpyClocks,
    charge: Callable[[], None],
    unpaid_ns: Callable[[], int],
) -> type:
    base = _rclpy.Clock
    kinds, point = _rclpy.ClockType, _rclpy.rcl_time_point_t

    class VirtualClock(base):  # type: ignore[misc, valid-type]
        """A clock of any type: underneath, a ROS clock whose time is set by us."""

        def __init__(self, kind: int) -> None:
            base.__init__(self, int(kinds.ROS_TIME))
            base.set_ros_time_override_is_enabled(self, True)
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
            base.set_ros_time_override(self, point(time_ns, int(kinds.ROS_TIME)))

        def get_now(self) -> Any:
            charge()
            time_ns = self.offset_ns + clocks.now_ns() + unpaid_ns()
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
