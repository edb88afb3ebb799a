"""rclpy's executors with a wait set that they keep, instead of building two a message.

`Executor._wait_for_ready_callbacks`, written anew in rclpy's order: tasks, waitables, and node by
node timers, subscriptions, guard conditions, clients, services. Whoever may not run now because
of its callback group is looked at as rclpy does it, with a wait set for this one look. Stands
aside where rclpy's own function is not one of those that it was written after: that one then
runs, slower, over our wait sets.
"""

from __future__ import annotations

import hashlib
import inspect
from collections.abc import Callable, Generator, Iterable
from typing import Any

import rclpy.executors
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import (
    ConditionReachedException,
    ExternalShutdownException,
    ShutdownException,
    TimeoutException,
    TimeoutObject,
    timeout_sec_to_nsec,
)

from grader.run.lockstep import contract, faults, waitsets
from grader.run.lockstep.faults import as_python_does, pass_on
from grader.run.lockstep.times import NEVER
from grader.run.student.views import Look, View

#: SHA-256 of the source of rclpy's function in the releases that this was tested with, and in
#: which order each goes through the tasks in progress.
KNOWN: dict[str, Callable[[list[Any]], Iterable[Any]]] = {
    # 7.1.4 to 7.1.8
    "f4ad71c9cd36740155e728956db585a6608e4df65f823cb1b2d6ce94992efb16": reversed,
    # 9.1.2
    "752e9ecbb147dcfa2db666b8312a72cc026c82c4245a35283ca0b7ba230c1a98": iter,
}


def install() -> None:
    """Replace rclpy's function, if it and what it uses are known."""
    global _in_order
    order = known()
    if order is not None and not contract.broken(contract.EXECUTOR):
        _in_order = order
        rclpy.executors.Executor._wait_for_ready_callbacks = _wait_for_ready_callbacks
        rclpy.executors._WorkTracker.__enter__ = _begin_work
        rclpy.executors._WorkTracker.__exit__ = _end_work


def _begin_work(self: Any) -> None:
    """As rclpy's, which takes a lock for it: here no two threads run at once."""
    self._num_work_executing += 1


def _end_work(self: Any, *_: object) -> None:
    """The same; whoever waits for all work's end is told."""
    self._num_work_executing -= 1
    if self._work_condition._waiters:
        with self._work_condition:
            self._work_condition.notify_all()


def allow_nested_spins() -> None:
    """Have an executor that is told to spin within a spin do so, as rclpy's did until 7.1.8.

    Since then it raises RuntimeError('Executor is already spinning'). The same submission is to get
    the same verdict with each: see `deadlock` for what becomes of most.
    """

    def enter_spin(self: Any) -> None:
        self._is_spinning = True

    if hasattr(rclpy.executors.Executor, "_enter_spin"):
        rclpy.executors.Executor._enter_spin = enter_spin


def known() -> Callable[[list[Any]], Iterable[Any]] | None:
    """The order in which the installed rclpy goes through tasks, where that is known."""
    source = inspect.getsource(rclpy.executors.Executor._wait_for_ready_callbacks)
    return KNOWN.get(hashlib.sha256(source.encode()).hexdigest())


_in_order: Callable[[list[Any]], Iterable[Any]]


def _look(executor: Any, nodes: list[Any]) -> Look:
    """At what of these nodes can be executed."""
    view: View | None = getattr(executor, "_view_in_virtual_time", None)
    if view is None or not view.is_of(nodes):
        for node in nodes:  # a class in place of a node is not ours to explain
            pass_on(iter, pass_on(getattr, node, "subscriptions"))
        view = executor._view_in_virtual_time = View(nodes, executor._context.handle)
    if view.all_can_execute() and not view.look.is_used:
        return view.look
    return Look(nodes, executor.can_execute, executor._context.handle)


def _wait_for_ready_callbacks(
    self: Any,
    timeout_sec: float | TimeoutObject | None = None,
    nodes: list[Any] | None = None,
    condition: Callable[[], bool] = lambda: False,
) -> Generator[tuple[Any, Any, Any], None, None]:
    """As rclpy's."""
    try:
        yield from _work(self, timeout_sec, nodes, condition)
    except Exception as error:
        faults.report(error)
        raise


def _work(
    executor: Any,
    timeout_sec: float | TimeoutObject | None,
    nodes: list[Any] | None,
    condition: Callable[[], bool],
) -> Iterable[tuple[Any, Any, Any]]:
    timeout_ns = timeout_sec_to_nsec(
        timeout_sec.timeout if isinstance(timeout_sec, TimeoutObject) else timeout_sec
    )
    end_ns = waitsets.WAITER.deadline(timeout_ns) if timeout_ns > 0 else NEVER
    yielded_work = False
    look: Look | None = None
    while not yielded_work and not executor._is_shutdown and not condition():
        used = list(executor._nodes) if nodes is None else nodes
        if executor._tasks:
            for work in _tasks(executor, used):
                yielded_work = True
                yield work
            look = None
        # nobody has changed anything since the last look where there is nobody else
        if look is None or not waitsets.WAITER.is_alone:
            look = _look(executor, used)
        is_out = _wait(executor, look, timeout_ns, end_ns)
        if look.may_have_work():
            look.is_used = True
            try:
                for work in _ready(executor, look, used):
                    yielded_work = True
                    yield work
            finally:
                look.is_used = False
        if timeout_ns == 0 or is_out:
            as_python_does(TimeoutException())
    if executor._is_shutdown:
        as_python_does(ShutdownException())
    if condition():
        as_python_does(ConditionReachedException())


def _tasks(executor: Any, nodes: list[Any]) -> Iterable[tuple[Any, Any, Any]]:
    """The tasks in progress."""
    with executor._tasks_lock:
        tasks = list(executor._tasks)
    for task, entity, node in _in_order(tasks):
        if not task.executing() and not task.done() and (node is None or node in nodes):
            yield task, entity, node
    with executor._tasks_lock:
        executor._tasks = [entry for entry in executor._tasks if not entry[0].done()]
        executor._tasks = [entry for entry in executor._tasks if not entry[0].cancelled()]


def _wait(executor: Any, look: Look, timeout_ns: int, end_ns: int) -> bool:
    """Wait until something is ready; whether the time is out."""
    wait_set = look.wait_set
    for guard in look.guards:  # triggered but not handled
        if guard._executor_triggered:
            guard.trigger()
    wait_set.guards = [guard.handle for guard in look.guards]
    for own in (executor._guard, executor._sigint_gc):
        if own is not None:  # as after the executor's shutdown
            wait_set.guards.append(own.handle)
    wait_set.end_ns = end_ns
    with executor._context.handle:
        wait_set.wait(timeout_ns)
    if executor._is_shutdown:
        as_python_does(ShutdownException())
    if not executor._context.ok():
        as_python_does(ExternalShutdownException())
    for guard in look.guards:
        if guard.handle in wait_set.ready_guards:
            guard._executor_triggered = True
    return wait_set.is_out


def _can_execute(group: Any, entity: Any) -> bool:
    """As the group says, without a lock where we know what it would say."""
    if type(group) is MutuallyExclusiveCallbackGroup:
        return group._active_entity is None
    return bool(group.can_execute(entity))


def _ready(executor: Any, look: Look, nodes: list[Any]) -> Iterable[tuple[Any, Any, Any]]:
    """What is ready, as tasks, in rclpy's order."""
    ready = look.wait_set.take_ready()
    make = executor._make_handler
    if look.may_have_waitables():
        for node in nodes:
            for waitable in node.waitables:
                is_ready = waitable in look.waitables and waitable.is_ready(look.wait_set)
                if is_ready and waitable.callback_group.can_execute(waitable):
                    yield make(waitable, node, executor._take_waitable), waitable, node
    if not look.guards:
        if not ready:
            return
        if len(ready) == 1:  # as below, where mostly nothing else is ready
            entity, node, take = look.by_handle[ready[0]]
            is_ready = take != "_take_timer" or ready[0].is_timer_ready()
            if is_ready and _can_execute(entity.callback_group, entity):
                yield make(entity, node, getattr(executor, take)), entity, node
            return
    for node in nodes:
        for timer in node.timers:
            is_ready = timer.handle in ready and timer.handle.is_timer_ready()
            if is_ready and timer.callback_group.can_execute(timer):
                yield make(timer, node, executor._take_timer), timer, node
        for subscription in node.subscriptions:
            if subscription.handle in ready and subscription.callback_group.can_execute(
                subscription
            ):
                yield make(subscription, node, executor._take_subscription), subscription, node
        for guard in node.guards:
            if guard._executor_triggered and guard.callback_group.can_execute(guard):
                yield make(guard, node, executor._take_guard_condition), guard, node
        for client in node.clients:
            if client.handle in ready and client.callback_group.can_execute(client):
                yield make(client, node, executor._take_client), client, node
        for service in node.services:
            if service.handle in ready and service.callback_group.can_execute(service):
                yield make(service, node, executor._take_service), service, node
