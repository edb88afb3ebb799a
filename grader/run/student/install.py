"""Puts rclpy into virtual time: the last step before a submission is run."""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable, Sequence
from types import CodeType
from typing import Any

import rclpy
import rclpy.action
import rclpy.clock
import rclpy.executors
import rclpy.experimental
import rclpy.node
import rclpy.task
import rclpy.timer
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

from grader.run.lockstep import actions, endpoints, events, faults, rclpy_clocks, waitsets
from grader.run.lockstep.protocol import Kind
from grader.run.student import chance, deadlock, executor, graph, hooks, threads, witness
from grader.run.student.scheduler import Scheduler
from grader.run.student.simulator_link import SimulatorLink
from grader.run.student.telling import Teller
from grader.run.student.waiting import VirtualWaiter, clock_event_class


def prepare() -> None:
    """What needs neither the link nor the clocks; it may come long before `install`."""
    # first: it looks at what is replaced in `install`
    executor.install()
    executor.allow_nested_spins()


def install(
    scheduler: Scheduler,
    nodes: Sequence[graph.Name],
    refuse: Callable[[str], None],
    teller: Teller,
    tells_apart: bool = False,
) -> tuple[SimulatorLink, witness.Witness]:
    """Replace what tells or waits for time in rclpy, after `prepare`; who looks on comes last.

    Args:
        nodes: the simulator's.
        refuse: told what virtual time cannot follow; does not return.
        tells_apart: whether a node's clock tells another time each time it is asked.
    """
    link = SimulatorLink(scheduler, refuse)

    def now_ns() -> int:
        return scheduler.now_ns

    unpaid_ns = (lambda: scheduler.unpaid_ns) if tells_apart else (lambda: 0)
    clocks = rclpy_clocks.install(_rclpy, now_ns, scheduler.charge, unpaid_ns)
    scheduler.clocks.append(clocks.set_now)
    scheduler.time_source = _Guarded(link)
    _rclpy.ClockEvent = clock_event_class(scheduler)
    waiter = VirtualWaiter(scheduler, link, clocks)
    waitsets.install(waiter)
    endpoints.install(link)
    actions.install()
    _guard_entities()
    graph.install(link, rclpy.node.Node, nodes)
    chance.order_nodes(rclpy.node.Node)
    _charge_for(rclpy.task.Future, "done", scheduler)
    _tell_if_ok(scheduler)
    _replace_events_executor()
    scheduler.on_foreign_thread = lambda: refuse(
        "runs Python in a thread that a C extension has started"
    )
    looks_on = witness.Witness(teller, _is_met)
    link.on_standstill = lambda: _look_for_deadlock(
        scheduler, link, waiter, looks_on, runs_callback
    )
    link.on_over = lambda: looks_on.over(scheduler.main.ident)
    threads.ON_ERROR = looks_on.thread_raised
    scheduler.on_waited = looks_on.callbacks.waited
    runs_callback = rclpy.task.Task.__call__.__code__
    hooks.install(looks_on)
    hooks.install_actions(looks_on)
    return link, looks_on


def _is_met(kind: str, entity: Any) -> Callable[[], bool]:
    """The entity itself is not to live longer for it."""
    handle = entity._client_handle if kind == "action_client" else entity.handle
    endpoint = handle.endpoints[0]
    return lambda: endpoint.matches > 0


class _Guarded:
    """Moves time; whoever waits for that has to hear of no mistake of ours."""

    def __init__(self, link: SimulatorLink) -> None:
        self.advance = faults.guarded(link.advance)


def _guard_entities() -> None:
    """A mistake of ours must not become the submission's, whatever it catches."""
    for kind in (
        *(endpoints.Publisher, endpoints.Subscription, endpoints.Client, endpoints.Service),
        *(endpoints.Registered, endpoints.Node),
        *(actions.ActionClient, actions.ActionServer, actions.ActionGoalHandle),
        *(waitsets.Timer, events.EventHandle),
    ):
        faults.guard_methods(kind)
    waitsets.WaitSet.wait = faults.guarded(waitsets.WaitSet.wait)  # type: ignore[method-assign]


def _charge_for(owner: Any, name: str, scheduler: Scheduler) -> None:
    """Loops that only ask this must not stop time."""
    ask = getattr(owner, name)

    @functools.wraps(ask)
    def asked(self: Any, *args: Any) -> Any:
        scheduler.charge()
        return faults.pass_on(ask, self, *args)

    setattr(owner, name, asked)


def _tell_if_ok(scheduler: Scheduler) -> None:
    """The same for contexts, without rclpy's lock: executors ask three times a message."""

    def ok(self: Any) -> bool:
        scheduler.charge()
        context = self.handle
        if context is None:
            return False
        with context:
            return bool(faults.pass_on(context.ok))

    rclpy.context.Context.ok = functools.wraps(rclpy.context.Context.ok)(ok)


def _replace_events_executor() -> None:
    """Events come from DDS's threads, when they like; the results are those of the other one."""

    class EventsExecutor(rclpy.executors.SingleThreadedExecutor):
        """As rclpy's, but it waits for what it serves."""

    if hasattr(rclpy.experimental, "EventsExecutor"):
        rclpy.experimental.EventsExecutor = EventsExecutor
    module = sys.modules.get("rclpy.experimental.events_executor")
    if module is not None:
        setattr(module, EventsExecutor.__name__, EventsExecutor)


def _look_for_deadlock(
    scheduler: Scheduler,
    link: SimulatorLink,
    waiter: VirtualWaiter,
    looks_on: witness.Witness,
    runs_callback: CodeType,
) -> None:
    if waiter.is_hopeful():
        return
    link.on_standstill = lambda: None  # once is enough
    waits = [
        rclpy.client.Client.call,
        rclpy.timer.Rate.sleep,
        rclpy.action.ActionClient.send_goal,
        rclpy.action.ActionClient._get_result,
        rclpy.action.ActionClient._cancel_goal,
    ]
    found = deadlock.find(scheduler, runs_callback, frozenset(w.__code__ for w in waits))
    if found:
        print(found.text, file=sys.stderr, flush=True)
        looks_on.stuck(found.kind, found.lines)
    elif lines := deadlock.find_waiting(scheduler):
        looks_on.stuck("call", lines)
    link.note(Kind.STUCK if found else Kind.WAITING)
