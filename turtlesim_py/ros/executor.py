"""Serve a node the way the original does: once a tick, each ready entity at most once.

rclpy's executors serve one entity for each wait set that they build, and building one costs more
than everything else in a tick. This one keeps its wait set until the node's entities change.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Coroutine, Iterable
from contextlib import suppress
from itertools import product
from typing import Any, Final

from rclpy.action import ActionServer
from rclpy.event_handler import EventHandler
from rclpy.exceptions import InvalidHandle
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.waitable import NumberOfEntities, Waitable

#: How often it polls whatever may have arrived [spins]: QoS events, which bring no more than a
#: warning in the log, and with `rely_on_arrivals` also the expiry of results.
QUIET_SPINS = 16

#: More than any libc's sem_t [bytes]; the number is its first 32 bits.
SEMAPHORE_BYTES: Final = 64
#: What an action server is asked for.
REQUESTS: Final = ("goal", "cancel", "result")
#: Gets the name of what was served, and the exception.
OnFailure = Callable[[str, Exception], None]


class TickExecutor:
    """Serves the subscriptions, services and waitables of one node; it has no others.

    It never waits: the pacer does. It stands where rclpy's nodes keep their executor, because
    that is what they `wake` when an entity appears or disappears.

    Args:
        on_failure: called with the exception of a callback, or of the read of its message;
            without one, it is raised in `spin_some`.
    """

    def __init__(self, node: Node, on_failure: OnFailure | None = None) -> None:
        self._node = node
        self._on_failure = on_failure
        self._wait_set: Any = None
        self._subscriptions: dict[int, Subscription] = {}
        self._services: dict[int, Service] = {}
        self._actions: list[Waitable] = []
        self._events: list[Waitable] = []
        self._spins = 0
        self._found = False
        self._arrivals: Arrivals | None = None
        node.executor = self

    def rely_on_arrivals(self) -> None:
        """From now on, poll in most spins only when the middleware has told of an arrival."""
        self._arrivals = Arrivals()
        self._wait_set = None  # so that they get to know the entities

    def spin_some(self) -> None:
        """Serve at most one message or request of every entity that has one.

        In rclcpp's order: subscriptions, services, waitables (actions and QoS events), those of a
        kind as they were created. A burst of commands is therefore consumed one a tick, as in the
        original. What fails hinders none of the others.
        """
        if self._wait_set is None:
            self._collect()
        self._spins += 1
        is_quiet = self._spins % QUIET_SPINS != 0
        has_news = self._arrivals is None or self._arrivals.take()
        # where something was found, more may be waiting behind it
        if is_quiet and not (has_news or self._found):
            return
        waitables = self._actions if is_quiet else self._actions + self._events
        wait_set = self._polled(waitables)
        subscriptions = wait_set.get_ready_entities("subscription")
        services = wait_set.get_ready_entities("service")
        ready = [waitable for waitable in waitables if waitable.is_ready(wait_set)]
        self._found = bool(subscriptions or services or ready)
        # What is not in these dictionaries belongs to an action.
        for pointer in subscriptions:
            if pointer in self._subscriptions:
                self._guard(_serve_message, self._subscriptions[pointer])
        for pointer in services:
            if pointer in self._services:
                self._guard(_serve_request, self._services[pointer])
        for waitable in ready:
            self._guard(_serve_waitable, waitable)

    def _guard(self, serve: Callable[[Any], None], entity: Any) -> None:
        try:
            serve(entity)
        except Exception as error:
            if self._on_failure is None:
                raise
            self._on_failure(_name(entity), error)

    def wait_for(self, topic: str, patience_ns: int) -> None:
        """Serve the subscription to `topic` alone, as soon as it has a message.

        Waits at most so long [ns]; not at all where there is no such subscription.
        """
        for subscription in self._node.subscriptions:
            if subscription.topic == topic:
                wait_set = _rclpy.WaitSet(1, 0, 0, 0, 0, 0, self._node.context.handle)
                wait_set.clear_entities()
                wait_set.add_subscription(subscription.handle)
                wait_set.wait(patience_ns)
                self._guard(_serve_message, subscription)
                return

    def wake(self) -> None:
        """Note that the node's entities have changed."""
        self._wait_set = None

    def add_node(self, node: Node) -> None:
        """Called by the node when this executor becomes its executor."""
        assert node is self._node, "this executor serves one node"

    def _polled(self, waitables: list[Waitable]) -> Any:
        """Return a wait set that knows what is ready now."""
        wait_set = self._wait_set
        # rcl forgets, in each wait, what was not ready
        wait_set.clear_entities()
        for subscription in self._subscriptions.values():
            wait_set.add_subscription(subscription.handle)
        for service in self._services.values():
            wait_set.add_service(service.handle)
        for waitable in waitables:
            waitable.add_to_wait_set(wait_set)
        wait_set.wait(0)
        return wait_set

    def _collect(self) -> None:
        node = self._node
        assert not [*node.timers, *node.clients, *node.guards], "not served by this executor"
        self._subscriptions = {item.handle.pointer: item for item in node.subscriptions}
        self._services = {item.handle.pointer: item for item in node.services}
        self._events = [item for item in node.waitables if isinstance(item, EventHandler)]
        self._actions = [item for item in node.waitables if item not in self._events]
        count = NumberOfEntities()
        for waitable in node.waitables:
            count += waitable.get_num_entities()
        self._wait_set = _rclpy.WaitSet(
            len(self._subscriptions) + count.num_subscriptions,
            count.num_guard_conditions,
            count.num_timers,
            count.num_clients,
            len(self._services) + count.num_services,
            count.num_events,
            node.context.handle,
        )
        if self._arrivals is not None and not self._arrivals.watch(
            self._subscriptions.values(), self._services.values(), self._actions
        ):
            self._arrivals = None


def _name(entity: Any) -> str:
    for attribute in ("topic", "srv_name"):
        if name := getattr(entity, attribute, ""):
            return str(name)
    return "an action"


# What a callback of the same tick has destroyed raises InvalidHandle and is left alone.


def _serve_message(subscription: Subscription) -> None:
    try:
        with subscription.handle:
            received = subscription.handle.take_message(subscription.msg_type, subscription.raw)
    except InvalidHandle:
        return
    if received is not None:
        subscription.callback(received[0])


def _serve_request(service: Service) -> None:
    try:
        with service.handle:
            request, header = service.handle.service_take_request(service.srv_type.Request)
    except InvalidHandle:
        return
    if header is not None:
        response = service.srv_type.Response()
        try:
            response = service.callback(request, response)
        finally:  # an empty answer is better than none: a client waits for it
            with suppress(InvalidHandle):
                service.send_response(response, header)


def _serve_waitable(waitable: Waitable) -> None:
    try:
        with waitable:
            data = waitable.take_data()
    except InvalidHandle:
        return
    _run(waitable.execute(data))


def _run(coroutine: Coroutine[Any, Any, None]) -> None:
    """Run a coroutine that never really waits: rclpy's are, where the callbacks are functions."""
    try:
        coroutine.send(None)
    except StopIteration:
        return
    raise RuntimeError("a callback of this node awaits something")


class Arrivals:
    """Tells without a wait whether anything has arrived for the entities that are watched.

    rclpy has only the wait set for that question; to fill and ask one costs more than everything
    else in an idle tick. rcl, below it, calls a C function for each message and request. Here that
    is libc's `sem_post`, which raises a number in memory: no Python runs, and no thread wakes.
    """

    def __init__(self) -> None:
        semaphore = ctypes.create_string_buffer(SEMAPHORE_BYTES)  # all zeros: it counts 0
        # never freed: the middleware's threads may still count while Python ends
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(semaphore))
        self._where = ctypes.c_void_p(ctypes.addressof(semaphore))
        self._count = ctypes.c_uint32.from_buffer(semaphore)

    def watch(
        self,
        subscriptions: Iterable[Subscription],
        services: Iterable[Service],
        waitables: Iterable[Waitable],
    ) -> bool:
        """Watch these from now on, and count what they have already; False where that cannot be.

        That is with a middleware that does not tell, a waitable that is no action server, or a ROS
        that is built in another way.
        """
        try:
            count = ctypes.cast(ctypes.CDLL(None).sem_post, ctypes.c_void_p)
            rcl, rcl_action = ctypes.CDLL("librcl.so"), ctypes.CDLL("librcl_action.so")
            calls = [(rcl.rcl_subscription_set_on_new_message_callback, it) for it in subscriptions]
            calls += [(rcl.rcl_service_set_on_new_request_callback, it) for it in services]
            for waitable, kind in product(waitables, REQUESTS):
                if not isinstance(waitable, ActionServer):
                    return False
                tell = getattr(rcl_action, f"rcl_action_server_set_{kind}_service_callback")
                calls.append((tell, waitable))
            return not any(
                tell(ctypes.c_void_p(_handle(it).pointer), count, self._where) for tell, it in calls
            )
        except (OSError, AttributeError):  # no such library, function or handle
            return False

    def take(self) -> bool:
        """Return whether anything has arrived since the last call."""
        if not self._count.value:
            return False
        self._count.value = 0  # before it is read: what arrives meanwhile counts again
        return True


def _handle(entity: Any) -> Any:
    return entity._handle if isinstance(entity, ActionServer) else entity.handle
