"""rclpy's publishers, subscriptions, clients and services, counted and served by us.

Each is a subclass of rclpy's own class in C++, put into its place in rclpy's extension module, so
that the Python of rclpy stays as it is. Used by both sides of the link.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.qos import QoSProfile
from rclpy.serialization import serialize_message

from grader.run.lockstep.faults import pass_on
from grader.run.lockstep.registry import DEPTH, Endpoint, EndpointRegistry, Reader, Writer

_Publisher, _Subscription = _rclpy.Publisher, _rclpy.Subscription
_Client, _Service = _rclpy.Client, _rclpy.Service

REGISTRY: EndpointRegistry
#: The time [ns] that messages are stamped with, instead of real ones.
NOW_NS: Callable[[], int]


def install(registry: EndpointRegistry, now_ns: Callable[[], int]) -> None:
    """Put the classes of this module into rclpy's extension module."""
    global REGISTRY, NOW_NS
    REGISTRY, NOW_NS = registry, now_ns
    for name in ("Publisher", "Subscription", "Client", "Service"):
        setattr(_rclpy, name, globals()[name])


def profile(c_qos: Any) -> QoSProfile:
    """Rclpy's Python form of a C profile."""
    return QoSProfile(**c_qos.to_dict())


def deepened(c_qos: Any) -> Any:
    """The same C profile for a reader that loses nothing while we look away."""
    fields = c_qos.to_dict()
    return QoSProfile(**{**fields, "depth": max(fields["depth"], DEPTH)}).get_c_qos_profile()


def ros_type(python_type: type) -> str:
    """A message or service class's ROS name: "geometry_msgs/msg/Twist"."""
    package, kind, *_ = python_type.__module__.split(".")
    return f"{package}/{kind}/{python_type.__name__}"


def weakly(handle: Any, method: Callable[..., Any], *args: Any) -> Callable[[], Any]:
    """A call of `method(handle, *args)` that does not keep the handle alive."""
    reference = weakref.ref(handle)

    def call() -> Any:
        alive = reference()
        return None if alive is None else method(alive, *args)

    return call


def matching(handle: Any, method: Callable[..., Any], *args: Any) -> Callable[[int], bool]:
    """Whether DDS knows so many counterparts: `method` counts them, or tells if there is one."""
    ask = weakly(handle, method, *args)

    def matches(number: int) -> bool:
        try:
            known = ask()
        except _rclpy.RCLError:
            return True  # after rclpy.shutdown() nobody gets connected any more
        return bool(known == (bool(number) if isinstance(known, bool) else number))

    return matches


class Registered:
    """What our endpoint classes have in common."""

    endpoints: list[Endpoint]

    def register(self, *endpoints: Endpoint) -> None:
        """Have the registry know the endpoints for as long as this object lives."""
        self.endpoints = list(endpoints)
        for endpoint in endpoints:
            REGISTRY.add(endpoint)
        weakref.finalize(self, REGISTRY.remove, self.endpoints).atexit = False

    def destroy_when_not_in_use(self) -> None:
        """As in rclpy, when the registry agrees."""
        destroy = super().destroy_when_not_in_use  # type: ignore[misc]
        REGISTRY.request_destroy(self.endpoints, destroy)


class Publisher(Registered, _rclpy.Publisher):
    """A publisher that counts."""

    def __init__(self, node: Any, msg_type: type, topic: str, c_qos: Any, *more: Any) -> None:
        pass_on(_Publisher.__init__, self, node, msg_type, topic, c_qos, *more)
        self.writer = Writer(
            f"topic {self.get_topic_name()}",
            ros_type(msg_type),
            profile(c_qos),
            matching(self, _Publisher.get_subscription_count),
            is_stream=True,
        )
        self.register(self.writer)

    def get_subscription_count(self) -> int:
        """As in rclpy."""
        REGISTRY.before_question()
        return int(_Publisher.get_subscription_count(self))

    def publish(self, message: Any) -> None:
        """Publish and count."""
        REGISTRY.before_send(self.writer)
        pass_on(_Publisher.publish, self, message)
        REGISTRY.after_send(self.writer)

    def publish_raw(self, message: bytes) -> None:
        """Publish serialized bytes and count."""
        REGISTRY.before_send(self.writer)
        pass_on(_Publisher.publish_raw, self, message)
        REGISTRY.after_send(self.writer)


class Subscription(Registered, _rclpy.Subscription):
    """A subscription that takes from an reader."""

    def __init__(self, node: Any, msg_type: type, topic: str, c_qos: Any, *more: Any) -> None:
        if more and more[0] is not None:  # a content filter, since rclpy 7.1.8
            self._refuse_filter()
        pass_on(_Subscription.__init__, self, node, msg_type, topic, deepened(c_qos), *more)
        self.reader = Reader(
            f"topic {self.get_topic_name()}",
            ros_type(msg_type),
            profile(c_qos),
            matching(self, _Subscription.get_publisher_count),
            weakly(self, _take_message, msg_type),
        )
        REGISTRY.arrival_signal.attach("rcl_subscription_set_on_new_message_callback", self.pointer)
        self.register(self.reader)

    def get_publisher_count(self) -> int:
        """As in rclpy."""
        REGISTRY.before_question()
        return int(_Subscription.get_publisher_count(self))

    def set_content_filter(self, *args: Any) -> None:
        """As in rclpy, since 7.1.8."""
        self._refuse_filter()
        pass_on(_Subscription.set_content_filter, self, *args)

    def _refuse_filter(self) -> None:
        """Nobody would know how many messages are to come."""
        REGISTRY.refuse("subscribes with a content filter")

    def take_message(self, _: type, raw: bool) -> Any:
        """The oldest message in the reader, or None."""
        item = self.reader.pop()
        if item is not None and raw:
            return serialize_message(item[0]), item[1]
        return item


def _take_message(handle: Any, msg_type: type) -> Any:
    item = _Subscription.take_message(handle, msg_type, False)
    if item is not None:
        item[1]["source_timestamp"] = item[1]["received_timestamp"] = NOW_NS()
    return item


class Client(Registered, _rclpy.Client):
    """A service client that counts, and takes from an reader."""

    def __init__(self, node: Any, srv_type: Any, name: str, c_qos: Any, *more: Any) -> None:
        pass_on(_Client.__init__, self, node, srv_type, name, deepened(c_qos), *more)
        matches = matching(self, _Client.service_server_is_available)
        qos, kind, name = profile(c_qos), ros_type(srv_type), self.service_name
        self.writer = Writer(f"request {name}", kind, qos, matches)
        take = weakly(self, some(_Client.take_response), srv_type.Response)
        channel = f"response {name}"
        self.reader = Reader(channel, kind, qos, None, take, REGISTRY.shared_arrivals(channel))
        REGISTRY.arrival_signal.attach("rcl_client_set_on_new_response_callback", self.pointer)
        self.register(self.writer, self.reader)

    def service_server_is_available(self) -> bool:
        """As in rclpy."""
        REGISTRY.before_question()
        return bool(_Client.service_server_is_available(self))

    def send_request(self, request: Any) -> int:
        """Send and count."""
        REGISTRY.before_send(self.writer)
        number: int = pass_on(_Client.send_request, self, request)
        REGISTRY.after_send(self.writer)
        return number

    def take_response(self, _: type) -> Any:
        """The oldest response in the reader, or (None, None)."""
        return self.reader.pop() or (None, None)


class Service(Registered, _rclpy.Service):
    """A service that takes from an reader, and counts."""

    def __init__(self, node: Any, srv_type: Any, name: str, c_qos: Any, *more: Any) -> None:
        pass_on(_Service.__init__, self, node, srv_type, name, deepened(c_qos), *more)
        qos, kind, name = profile(c_qos), ros_type(srv_type), self.name
        matches = matching(node, type(node).get_count_clients, name)
        take = weakly(self, some(_Service.service_take_request), srv_type.Request)
        channel = f"request {name}"
        self.reader = Reader(channel, kind, qos, matches, take)
        self.writer = Writer(f"response {name}", kind, qos, None)
        REGISTRY.arrival_signal.attach("rcl_service_set_on_new_request_callback", self.pointer)
        self.register(self.writer, self.reader)

    def service_take_request(self, _: type) -> Any:
        """The oldest request in the reader, or (None, None)."""
        return self.reader.pop() or (None, None)

    def service_send_response(self, response: Any, header: Any) -> None:
        """Send and count."""
        REGISTRY.before_send(self.writer)
        pass_on(_Service.service_send_response, self, response, header)
        REGISTRY.after_send(self.writer)


def some(take: Callable[..., Any]) -> Callable[..., Any]:
    """Rclpy takes a pair, of two Nones if there is nothing; an reader wants None then."""

    def taken(handle: Any, kind: type) -> Any:
        pair = take(handle, kind)
        return None if pair is None or pair[0] is None else pair

    return taken
