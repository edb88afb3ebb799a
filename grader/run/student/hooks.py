"""Puts a witness beside rclpy's methods: they are called as they were, and it hears of that."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Any

from grader.run.student import lists
from grader.run.student.witness import End, Witness, quietly


def install(witness: Witness) -> None:
    """Have rclpy's objects tell; `rclpy.node` is imported by now."""
    _where_known(_install, witness)


def install_actions(witness: Witness) -> None:
    """The same for action clients; `rclpy.action.client` is imported by now."""
    _where_known(_install_actions, witness)


def _where_known(install: Callable[[Witness], None], witness: Witness) -> None:
    """An rclpy that is made otherwise is left alone; half of what happens would be worse."""
    try:
        install(witness)
    except (AttributeError, ImportError):
        witness.is_blind()


def _install(witness: Witness) -> None:
    import rclpy.client
    import rclpy.executors
    import rclpy.publisher
    import rclpy.subscription
    import rclpy.task
    import rclpy.timer
    import rclpy.wait_for_message

    publisher, client = rclpy.publisher.Publisher, rclpy.client.Client
    subscription, executor = rclpy.subscription.Subscription, rclpy.executors.Executor

    _after(publisher, "__init__", lambda self, _: lists.accept_numbers(self.msg_type))
    _after(publisher, "__init__", lambda self, _: witness.made(
        "publisher", self, self.topic_name, self.msg_type))  # fmt: skip
    _after(subscription, "__init__", lambda self, _: witness.made(
        "subscription", self, self.topic_name, self.msg_type))  # fmt: skip
    _after(client, "__init__", lambda self, _: witness.made(
        "client", self, self.handle.service_name, self.srv_type))  # fmt: skip
    _after(publisher, "publish", lambda self, _: witness.used(self, is_sent=True))
    _after(client, "call_async", lambda self, future: _asked(witness, self, future))
    _awaits(witness, client, "wait_for_service", lambda self, _: self, lambda _, is_ready: is_ready)
    # what virtual time has put round it would take time
    is_done = inspect.unwrap(rclpy.task.Future.done)
    _awaits(witness, executor, "spin_until_future_complete", _first, lambda it, _: is_done(it))
    _watch_callbacks(witness, rclpy.task.Task)
    _after(rclpy.timer.Timer, "__init__", lambda self, _: witness.is_given(self.callback))
    _after(rclpy.timer.Timer, "__init__", lambda self, _: witness.has_timer(self))
    add = rclpy.task.Future.add_done_callback

    @functools.wraps(add)
    def added(self: Any, callback: Any) -> Any:
        quietly(witness.is_given, callback)
        return add(self, callback)

    rclpy.task.Future.add_done_callback = added

    take, look = executor._take_subscription, executor.wait_for_ready_callbacks

    @functools.wraps(take)
    def taken(self: Any, subscription: Any) -> Any:
        found = take(self, subscription)
        if found is not None:
            quietly(witness.used, subscription)
        return found

    @functools.wraps(look)
    def first_look(self: Any, *args: Any, **kwargs: Any) -> Any:
        executor.wait_for_ready_callbacks = look
        quietly(witness.spins)
        return look(self, *args, **kwargs)

    executor._take_subscription = taken
    executor.wait_for_ready_callbacks = first_look
    _watch_single_messages(witness, rclpy.wait_for_message)


def _watch_single_messages(witness: Witness, module: Any) -> None:
    """Have `wait_for_message` tell what it hears: it takes its message past all executors."""
    wait = module.wait_for_message

    @functools.wraps(wait)  # it is told by its name where a program is stuck in it
    def wait_for_message(msg_type: Any, node: Any, topic: Any, *args: Any, **kwargs: Any) -> Any:
        found = wait(msg_type, node, topic, *args, **kwargs)
        if found[0]:
            quietly(lambda: witness.heard(node.resolve_topic_name(topic)))
        return found

    module.wait_for_message = wait_for_message


def _install_actions(witness: Witness) -> None:
    from rclpy.action.client import ActionClient

    _after(ActionClient, "__init__", lambda self, _: witness.made(
        *("action_client", self, self._node.resolve_service_name(self._action_name)),
        self._action_type))  # fmt: skip
    _after(ActionClient, "send_goal_async", lambda self, _: witness.used(self))
    _awaits(witness, ActionClient, "wait_for_server", lambda self, _: self, lambda _, there: there)


def _after(owner: Any, name: str, look: Callable[[Any, Any], None]) -> None:
    """Have somebody look after each call of a method, at whose it is and what it has returned."""
    method = getattr(owner, name)

    @functools.wraps(method)
    def called(self: Any, *args: Any, **kwargs: Any) -> Any:
        returned = method(self, *args, **kwargs)
        quietly(look, self, returned)
        return returned

    setattr(owner, name, called)


def _asked(witness: Witness, client: Any, future: Any) -> None:
    """A request was sent; whoever waits for this future waits for the service."""
    witness.used(client, is_sent=True)
    future._witnessed = client._witnessed


def _first(_: Any, args: tuple[Any, ...]) -> Any:
    return args[0]


def _awaits(
    witness: Witness,
    owner: Any,
    name: str,
    whose: Callable[[Any, tuple[Any, ...]], Any],
    has_come: Callable[[Any, Any], bool],
) -> None:
    """Have a method tell for how long it waits.

    Args:
        whose: of its object and arguments, what knows the end that is waited for.
        has_come: of that and what the method returns, whether it has waited with success.
    """
    method = getattr(owner, name)

    @functools.wraps(method)
    def awaited(self: Any, *args: Any, **kwargs: Any) -> Any:
        waiter = quietly(whose, self, args or tuple(kwargs.values()))
        end: End | None = getattr(waiter, "_witnessed", None)
        if end is None:
            return method(self, *args, **kwargs)
        wait = quietly(witness.waits.since, end.name, end.type)
        returned = method(self, *args, **kwargs)
        quietly(lambda: witness.waits.over(wait, has_come=bool(has_come(waiter, returned))))
        return returned

    setattr(owner, name, awaited)


def _watch_callbacks(witness: Witness, task: Any) -> None:
    """Have the tasks that an executor runs tell when they begin and end."""
    run, callbacks, catching = task.__call__, witness.callbacks, witness.catching

    @functools.wraps(run)
    def call(self: Any) -> Any:
        lines = callbacks.begin()
        if lines is None:
            return run(self)
        tracing = quietly(catching.begin)
        try:
            return run(self)
        finally:
            quietly(catching.end, tracing, getattr(self, "_exception", None))
            quietly(callbacks.end, lines)

    task.__call__ = call
