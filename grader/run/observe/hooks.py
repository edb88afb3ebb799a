"""Has rclpy's objects call a witness; apart from that, their methods work as before.

In real time rclpy is also asked whether an endpoint has a counterpart. ROS finds that out after a
while, so it is asked again until there is one.
"""

from __future__ import annotations

import functools
import inspect
import threading
import time
import weakref
from _thread import start_new_thread
from collections.abc import Callable
from typing import Any

from grader.run.lockstep import faults
from grader.run.observe.account import quietly
from grader.run.observe.witness import UsedEnd, Witness

#: How rclpy is asked whether there is a counterpart, for each kind of endpoint.
ASKS: dict[str, Callable[[Any], bool]] = {
    "publisher": lambda publisher: publisher.get_subscription_count() > 0,
    "subscription": lambda subscription: subscription.get_publisher_count() > 0,
    "client": lambda client: client.service_is_ready(),
    "action_client": lambda client: client.server_is_ready(),
}
#: How often it is asked [s].
PERIOD_S = 0.5
#: The original, which does not call the witness.
_SLEEP = time.sleep


def install_in_threads(witness: Witness) -> None:
    """Have threads that end by an exception call, and print it without our frames."""

    def excepthook(args: threading.ExceptHookArgs) -> None:
        if args.exc_value is not None:
            faults.report(args.exc_value)
            witness.ending.thread_raised(args.exc_value)
            faults.hide_our_frames(args.exc_value)
            traceback = args.exc_value.__traceback__
            args = threading.ExceptHookArgs((args.exc_type, args.exc_value, traceback, args.thread))
        threading.__excepthook__(args)

    threading.excepthook = excepthook


def _where_known(install: Callable[[Witness], None]) -> Callable[[Witness], None]:
    """Install hooks, or nothing where rclpy has other internals: half of it would be worse."""

    def installed(witness: Witness) -> None:
        try:
            install(witness)
        except (AttributeError, ImportError):
            witness.discard()

    return installed


@_where_known
def install(witness: Witness) -> None:
    """Have rclpy's objects call; `rclpy.node` is imported by now."""
    import rclpy.client
    import rclpy.executors
    import rclpy.publisher
    import rclpy.subscription
    import rclpy.task
    import rclpy.timer
    import rclpy.wait_for_message

    publisher, client = rclpy.publisher.Publisher, rclpy.client.Client
    subscription, executor = rclpy.subscription.Subscription, rclpy.executors.Executor
    future, timer = rclpy.task.Future, rclpy.timer.Timer
    made = witness.made

    after(publisher, "__init__", lambda it, _: made("publisher", it, it.topic_name, it.msg_type))
    after(
        subscription, "__init__", lambda it, _: made("subscription", it, it.topic_name, it.msg_type)
    )
    after(client, "__init__", lambda it, _: made("client", it, it.handle.service_name, it.srv_type))
    after(timer, "__init__", lambda it, _: witness.ending.note_callback(it.callback))
    after(timer, "__init__", lambda it, _: witness.made_timer(it))
    after(publisher, "publish", lambda it, _: witness.used(it, is_sent=True))
    after(client, "call_async", lambda it, answer: _requested(witness, it, answer))
    _around_wait(witness, client, "wait_for_service", lambda it, _: it, lambda _, there: there)
    # virtual time's wrapper would cost time
    is_done = inspect.unwrap(future.done)
    _around_wait(
        witness,
        executor,
        "spin_until_future_complete",
        lambda _, args: args[0],
        lambda awaited, _: is_done(awaited),
    )
    _around_callbacks(witness, rclpy.task.Task)
    _before_done_callbacks(witness, future)
    _around_executor(witness, executor)
    _after_single_messages(witness, rclpy.wait_for_message)


@_where_known
def install_actions(witness: Witness) -> None:
    """Have action clients call; `rclpy.action.client` is imported by now."""
    from rclpy.action.client import ActionClient

    def made(client: Any, _: object) -> None:
        name = client._node.resolve_service_name(client._action_name)
        witness.made("action_client", client, name, client._action_type)

    after(ActionClient, "__init__", made)
    after(ActionClient, "send_goal_async", lambda it, _: witness.used(it))
    _around_wait(witness, ActionClient, "wait_for_server", lambda it, _: it, lambda _, there: there)


def _around(owner: Any, name: str, around: Callable[..., Any]) -> None:
    """Put a function in the place of another; it gets that, and then what that would get."""
    original = getattr(owner, name)

    @functools.wraps(original)  # it is shown by its name where a program is stuck in it
    def called(*args: Any, **kwargs: Any) -> Any:
        return around(original, *args, **kwargs)

    setattr(owner, name, called)


def after(owner: Any, name: str, call: Callable[[Any, Any], None]) -> None:
    """Have a function called after each call of a method, with its object and what it returned."""

    def called(method: Any, self: Any, *args: Any, **kwargs: Any) -> Any:
        returned = method(self, *args, **kwargs)
        quietly(call, self, returned)
        return returned

    _around(owner, name, called)


def _requested(witness: Witness, client: Any, answer: Any) -> None:
    """Note a sent request; a wait for its answer counts as a wait for the service."""
    witness.used(client, is_sent=True)
    answer._witnessed = client._witnessed


def _around_wait(
    witness: Witness,
    owner: Any,
    name: str,
    awaited: Callable[[Any, tuple[Any, ...]], Any],
    has_come: Callable[[Any, Any], bool],
) -> None:
    """Have the witness measure how long a method waits.

    Args:
        awaited: returns what is waited for, from the method's object and arguments.
        has_come: returns whether the wait was successful, from that and what the method returned.
    """

    def waiting(method: Any, self: Any, *args: Any, **kwargs: Any) -> Any:
        what = quietly(awaited, self, args or tuple(kwargs.values()))
        end: UsedEnd | None = getattr(what, "_witnessed", None)
        if end is None:
            return method(self, *args, **kwargs)
        wait = quietly(witness.begin_wait, end)
        returned = method(self, *args, **kwargs)
        quietly(lambda: witness.end_wait(wait, has_come=bool(has_come(what, returned))))
        return returned

    _around(owner, name, waiting)


def _around_callbacks(witness: Witness, task: Any) -> None:
    """Report to the witness when the tasks that an executor runs begin and end."""

    def call(run: Any, self: Any) -> Any:
        if not witness.begin_callback():
            return run(self)
        try:
            return run(self)
        finally:
            quietly(witness.end_callback, getattr(self, "_exception", None))

    _around(task, "__call__", call)


def _before_done_callbacks(witness: Witness, future: Any) -> None:
    def add(added: Any, self: Any, callback: Any) -> Any:
        quietly(witness.ending.note_callback, callback)
        return added(self, callback)

    _around(future, "add_done_callback", add)


def _around_executor(witness: Witness, executor: Any) -> None:
    """Report to the witness what subscriptions receive, and when an executor first spins."""

    def received(receive: Any, self: Any, subscription: Any) -> Any:
        found = receive(self, subscription)
        if found is not None:
            quietly(witness.used, subscription)
        return found

    def first_wait(wait: Any, self: Any, *args: Any, **kwargs: Any) -> Any:
        executor.wait_for_ready_callbacks = wait
        quietly(witness.spins)
        return wait(self, *args, **kwargs)

    _around(executor, "_take_subscription", received)
    _around(executor, "wait_for_ready_callbacks", first_wait)


def _after_single_messages(witness: Witness, module: Any) -> None:
    """Report what `wait_for_message` receives: its message goes past all executors."""

    def wait_for_message(
        wait: Any, msg_type: Any, node: Any, topic: Any, *args: Any, **kwargs: Any
    ) -> Any:
        found = wait(msg_type, node, topic, *args, **kwargs)
        if found[0]:
            quietly(lambda: witness.heard(node.resolve_topic_name(topic)))
        return found

    _around(module, "wait_for_message", wait_for_message)


# In real time ---------------------------------------------------------------------------------


def install_in_real_time(witness: Witness) -> None:
    """Have rclpy's objects call, and its waits report their length; poll it from now on."""
    import rclpy.clock
    import rclpy.timer

    install(witness)
    for kind, name in ((rclpy.clock.Clock, "sleep_until"), (rclpy.timer.Rate, "sleep")):
        time_waits(witness, kind, name)
    start_new_thread(_go_on_asking, (witness,))


def install_in_events_executor(witness: Witness, module: Any) -> None:
    """Have the executor in C++ call when it is made: it calls nothing of Python's but callbacks."""

    def events_executor(make: Any, *args: Any, **kwargs: Any) -> Any:
        quietly(witness.spins)
        return make(*args, **kwargs)

    _around(module, "EventsExecutor", events_executor)


def time_waits(witness: Witness, owner: Any, name: str) -> None:
    """Have a function that waits report to the witness how long it has waited."""

    def waiting(wait: Any, *args: Any, **kwargs: Any) -> Any:
        before_s = time.monotonic()
        returned = wait(*args, **kwargs)
        witness.waited(time.monotonic() - before_s)
        return returned

    _around(owner, name, waiting)


def is_met(kind: str, entity: Any) -> Callable[[], bool]:
    """Return a function that asks rclpy for a counterpart; it holds no reference to the entity."""
    alive = weakref.ref(entity)

    def ask() -> bool:
        there = alive()
        return there is not None and ASKS[kind](there)

    return ask


def _go_on_asking(witness: Witness) -> None:
    while True:
        _SLEEP(PERIOD_S)
        quietly(witness.write)
