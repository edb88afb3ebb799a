"""How rclpy's wait sets and clocks wait in virtual time, and what polling costs."""

from __future__ import annotations

from typing import Any

from grader.run.lockstep.rclpy_clocks import RclpyClocks
from grader.run.lockstep.times import NEVER
from grader.run.lockstep.waitsets import WaitSet
from grader.run.student.scheduler import Runner, Scheduler
from grader.run.student.simulator_link import SimulatorLink

#: What looking costs, and what handing out work costs on top [units].
LOOK_UNITS = 2
WORK_UNITS = 8
#: What the first, second, ... of several looks in a row costs that found nothing [ns].
EMPTY_NS = (*(250_000,) * 8, 2_000_000)


class VirtualWaiter:
    """Blocks the running thread in the scheduler."""

    def __init__(self, scheduler: Scheduler, link: SimulatorLink, clocks: RclpyClocks) -> None:
        self._scheduler = scheduler
        self._link = link
        self._waiting: list[tuple[WaitSet, Runner]] = []
        self._empty = 0
        self.tell_time = clocks.tell
        link.is_listening = self.is_listening
        link.on_arrival = self.on_arrival

    @property
    def graph_epoch(self) -> int:
        """Counts the changes of the graph; what belongs together is connected now."""
        self._link.connect()
        return self._link.graph_epoch

    @property
    def is_alone(self) -> bool:
        """Whether the program has but one thread."""
        return len(self._scheduler.runners) == 1

    def await_dds(self, what: str) -> None:
        """Really wait a little for DDS."""
        self._link.await_dds(what)

    def look_first(self) -> None:
        """Others first, if any can run."""
        self._scheduler.charge(LOOK_UNITS)
        self._scheduler.pass_on()

    def found_work(self) -> None:
        """Work takes time."""
        self._empty = 0
        self._scheduler.charge(WORK_UNITS)

    def found_nothing(self) -> None:
        """A loop of such looks must not stop time."""
        cost_ns = EMPTY_NS[min(self._empty, len(EMPTY_NS) - 1)]
        self._empty += 1
        self._scheduler.sleep(cost_ns)

    def wait_for(self, wait_set: WaitSet, deadline_ns: int) -> None:
        """Block until something may be ready."""
        self._empty = 0
        entry = (wait_set, self._scheduler.current)
        self._waiting.append(entry)
        try:
            self._scheduler.block(deadline_ns)
        finally:
            self._waiting.remove(entry)

    def deadline(self, timeout_ns: int) -> int:
        """When a time-out from now ends; a negative one never."""
        return NEVER if timeout_ns < 0 else min(NEVER, self._scheduler.now_ns + timeout_ns)

    def poke(self, _: object) -> None:
        """Have all look again: they are few."""
        for _, runner in self._waiting:
            self._scheduler.wake(runner)

    def on_arrival(self) -> None:
        """Wake those for whom something has come."""
        for wait_set, runner in self._waiting:
            for reader in wait_set.readers:
                if reader.items:
                    self._scheduler.wake(runner)
                    break

    def is_listening(self) -> bool:
        """Whether a blocked wait set would hear what the simulator publishes."""
        for wait_set, _ in self._waiting:
            for reader in wait_set.readers:
                if reader.hears:
                    return True
        return False

    def is_hopeful(self) -> bool:
        """Whether anything can still wake somebody."""
        return self.is_listening() or any(
            reader.awaited > 0 for wait_set, _ in self._waiting for reader in wait_set.readers
        )


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
