"""Puts rclpy into virtual time: how its wait sets and clocks wait, and what polling costs."""

from __future__ import annotations

import functools
import itertools
import sys
from collections.abc import Callable
from typing import Any

import rclpy
import rclpy.action
import rclpy.clock
import rclpy.executors
import rclpy.experimental
import rclpy.node
import rclpy.task
import rclpy.timer
from rcl_interfaces.msg import Log
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

from grader.run.clock.link import SimulatorLink
from grader.run.clock.scheduler import Runner, Scheduler
from grader.run.lockstep import actions, endpoints, faults, graph, waitsets
from grader.run.lockstep.endpoints import serialized
from grader.run.lockstep.waitsets import Waiter, WaitSet
from grader.text.message import msg

#: The costs of a wait, and of the work that it finds on top [units].
WAIT_UNITS = 2
WORK_UNITS = 8
#: The costs of the first, second, ... of several polls in a row that find nothing [ns].
EMPTY_NS = (*(250_000,) * 8, 2_000_000)


def install(
    scheduler: Scheduler,
    link: SimulatorLink,
    *,
    compares_stamps: bool,
    on_deadlock: Callable[[], None],
) -> None:
    """Replace rclpy's clocks and waits.

    Args:
        compares_stamps: whether a node's clock returns another time each time it is asked.
        on_deadlock: called once, when nothing can ever happen any more.
    """
    scheduler.advance = link.advance
    _rclpy.ClockEvent = clock_event_class(scheduler)
    waiter = VirtualWaiter(scheduler, link, on_deadlock, compares_stamps=compares_stamps)
    scheduler.on_moved = waiter.set_now
    waitsets.install(waiter)
    endpoints.install(link)
    actions.install()
    _guard_entities()
    graph.install()
    _order_nodes(rclpy.node.Node)
    _charge_for(rclpy.task.Future, "done", scheduler)
    _charge_for(rclpy.context.Context, "ok", scheduler)
    allow_nested_spins()
    _replace_events_executor()
    scheduler.on_unknown_thread = lambda: link.refuse(
        msg("runs Python in a thread that a C extension has started")
    )


# How it waits ---------------------------------------------------------------------------------


class VirtualWaiter(Waiter):
    """Blocks the running thread in the scheduler."""

    def __init__(
        self,
        scheduler: Scheduler,
        link: SimulatorLink,
        on_deadlock: Callable[[], None],
        *,
        compares_stamps: bool,
    ) -> None:
        super().__init__(lambda: scheduler.now_ns)
        self._scheduler = scheduler
        self._compares_stamps = compares_stamps
        self._link = link
        self._on_deadlock: Callable[[], None] | None = on_deadlock
        self._waiting: list[tuple[WaitSet, Runner]] = []
        self._empty = 0
        link.is_listening = self.is_listening
        link.on_arrival = self.on_arrival
        link.on_standstill = self.on_standstill

    def before_wait(self) -> None:
        """Let others run first, if any can."""
        self._scheduler.charge(WAIT_UNITS)
        self._scheduler.pass_on()

    def before_events(self) -> None:
        """Connect all endpoints, whose counterparts are the events."""
        self._link.connect()

    def found_work(self) -> None:
        """Charge for the work that a wait has found."""
        self._empty = 0
        self._scheduler.charge(WORK_UNITS)

    def found_nothing(self) -> None:
        """Charge for a poll that found nothing: a loop of them must not stop time."""
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

    def asked_ns(self) -> int:
        """Charge for the question; where stamps are compared, each answer is another."""
        scheduler = self._scheduler
        scheduler.charge()
        return scheduler.now_ns + (scheduler.unpaid_ns if self._compares_stamps else 0)

    def poke(self, _: object) -> None:
        """Wake all waiting threads: they are few."""
        for _, runner in self._waiting:
            self._scheduler.wake(runner)

    def on_arrival(self) -> None:
        """Wake the threads whose wait sets have something to read."""
        for wait_set, runner in self._waiting:
            if any(reader.items for reader in wait_set.readers):
                self._scheduler.wake(runner)

    def is_listening(self) -> bool:
        """Whether a blocked wait set would hear what others publish, or ask."""
        return any(reader.hears for wait_set, _ in self._waiting for reader in wait_set.readers)

    def on_standstill(self) -> None:
        """Report a deadlock, unless something may still come from others."""
        is_hopeful = self.is_listening() or any(
            reader.awaited > 0 for wait_set, _ in self._waiting for reader in wait_set.readers
        )
        if not is_hopeful and self._on_deadlock is not None:
            on_deadlock, self._on_deadlock = self._on_deadlock, None
            on_deadlock()


def clock_event_class(scheduler: Scheduler) -> type:
    """Return what `Clock.sleep_until` waits on."""

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


# What else is replaced ------------------------------------------------------------------------


def _guard_entities() -> None:
    """Guard our classes: a mistake of ours must not count as the submission's."""
    for kind in (
        *(endpoints.Publisher, endpoints.Subscription, endpoints.Client, endpoints.Service),
        *(endpoints.Registered, endpoints.Node),
        *(actions.ActionClient, actions.ActionServer, actions.ActionGoalHandle),
        *(waitsets.Timer, waitsets.EventHandle),
    ):
        faults.guard_methods(kind)
    waitsets.WaitSet.wait = faults.guarded(waitsets.WaitSet.wait)  # type: ignore[method-assign]


def _order_nodes(node_class: Any) -> None:
    """Order sets of nodes, as in executors, by their creation instead of their addresses."""
    serials = itertools.count()
    original = node_class.__init__

    @functools.wraps(original)
    def init(self: Any, *args: Any, **kwargs: Any) -> None:
        self._serial_in_virtual_time = next(serials)
        faults.pass_on(original, self, *args, **kwargs)

    node_class.__init__ = init
    node_class.__hash__ = lambda self: self._serial_in_virtual_time


def _charge_for(owner: Any, name: str, scheduler: Scheduler) -> None:
    """Charge for a method: loops that only call it must not stop time."""
    ask = getattr(owner, name)

    @functools.wraps(ask)
    def asked(self: Any, *args: Any) -> Any:
        scheduler.charge()
        return faults.pass_on(ask, self, *args)

    setattr(owner, name, asked)


def allow_nested_spins() -> None:
    """Have an executor spin within a spin, as rclpy's did until 7.1.8.

    Since then it raises RuntimeError('Executor is already spinning'). The same submission is to get
    the same verdict with each: most get stuck there.
    """

    def enter_spin(self: Any) -> None:
        self._is_spinning = True

    if hasattr(rclpy.executors.Executor, "_enter_spin"):
        rclpy.executors.Executor._enter_spin = enter_spin


def _replace_events_executor() -> None:
    """Replace the events executor, whose events come from DDS's threads in any order."""

    class EventsExecutor(rclpy.executors.SingleThreadedExecutor):
        """As rclpy's, but it waits for what it serves."""

    if hasattr(rclpy.experimental, "EventsExecutor"):
        rclpy.experimental.EventsExecutor = EventsExecutor
    module = sys.modules.get("rclpy.experimental.events_executor")
    if module is not None:
        setattr(module, EventsExecutor.__name__, EventsExecutor)


def publish_logs(link: SimulatorLink) -> None:
    """Have loggers publish on /rosout, too: what rclpy's C++ publishes, nobody hears here."""
    writer = graph.log_writer("/")
    writer.is_hidden = True  # the graph shows that of each node
    link.add(writer)
    log = _rclpy.rclpy_logging_rcutils_log
    level_of = type(Log().level)

    def logged(severity: Any, name: str, text: str, function: str, file: str, line: int) -> None:
        log(severity, name, text, function, file, line)
        publish(int(severity), name, text, function, line)

    @faults.guarded
    def publish(severity: int, name: str, text: str, function: str, line: int) -> None:
        level = bytes([severity]) if level_of is bytes else severity
        # without the file: it is a copy's
        message = Log(level=level, name=name, msg=text, function=function, line=line)
        message.stamp.sec, message.stamp.nanosec = divmod(link.now_ns(), 1_000_000_000)
        link.connect()
        link.publish(writer, serialized(message))

    _rclpy.rclpy_logging_rcutils_log = logged
