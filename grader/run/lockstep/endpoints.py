"""rclpy's publishers, subscriptions, clients and services, with our mail between them and DDS.

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

from grader.run.lockstep.registry import DEPTH, End, Inbox, Office, Outlet

_Publisher, _Subscription = _rclpy.Publisher, _rclpy.Subscription
_Client, _Service = _rclpy.Client, _rclpy.Service

OFFICE: Office
#: The time [ns] that messages are stamped with, instead of real ones.
NOW_NS: Callable[[], int]


def install(office: Office, now_ns: Callable[[], int]) -> None:
    """Put the classes of this module into rclpy's extension module."""
    global OFFICE, NOW_NS
    OFFICE, NOW_NS = office, now_ns
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


class Mailed:
    """What our endpoint classes have in common."""

    ends: list[End]

    def register(self, *ends: End) -> None:
        """Have the office know the ends for as long as this object lives."""
        self.ends = list(ends)
        for end in ends:
            OFFICE.add(end)
        weakref.finalize(self, OFFICE.remove, self.ends).atexit = False

    def destroy_when_not_in_use(self) -> None:
        """As in rclpy, when the office agrees."""
        destroy = super().destroy_when_not_in_use  # type: ignore[misc]
        OFFICE.retire(self.ends, destroy)


class Publisher(Mailed, _rclpy.Publisher):
    """A publisher that counts."""

    def __init__(self, node: Any, msg_type: type, topic: str, c_qos: Any) -> None:
        _Publisher.__init__(self, node, msg_type, topic, c_qos)
        count = weakly(self, _Publisher.get_subscription_count)
        self.outlet = Outlet(
            f"topic {self.get_topic_name()}",
            ros_type(msg_type),
            profile(c_qos),
            lambda number: count() == number,
            is_stream=True,
        )
        self.register(self.outlet)

    def get_subscription_count(self) -> int:
        """As in rclpy."""
        OFFICE.before_question()
        return int(_Publisher.get_subscription_count(self))

    def publish(self, message: Any) -> None:
        """Publish and count."""
        OFFICE.before_send(self.outlet)
        _Publisher.publish(self, message)
        OFFICE.after_send(self.outlet)

    def publish_raw(self, message: bytes) -> None:
        """Publish serialized bytes and count."""
        OFFICE.before_send(self.outlet)
        _Publisher.publish_raw(self, message)
        OFFICE.after_send(self.outlet)


class Subscription(Mailed, _rclpy.Subscription):
    """A subscription that takes from an inbox."""

    def __init__(self, node: Any, msg_type: type, topic: str, c_qos: Any) -> None:
        _Subscription.__init__(self, node, msg_type, topic, deepened(c_qos))
        count = weakly(self, _Subscription.get_publisher_count)
        self.inbox = Inbox(
            f"topic {self.get_topic_name()}",
            ros_type(msg_type),
            profile(c_qos),
            lambda number: count() == number,
            weakly(self, _take_message, msg_type),
        )
        OFFICE.bell.hang("rcl_subscription_set_on_new_message_callback", self.pointer)
        self.register(self.inbox)

    def get_publisher_count(self) -> int:
        """As in rclpy."""
        OFFICE.before_question()
        return int(_Subscription.get_publisher_count(self))

    def take_message(self, _: type, raw: bool) -> Any:
        """The oldest message in the inbox, or None."""
        item = self.inbox.pop()
        if item is not None and raw:
            return serialize_message(item[0]), item[1]
        return item


def _take_message(handle: Any, msg_type: type) -> Any:
    item = _Subscription.take_message(handle, msg_type, False)
    if item is not None:
        item[1]["source_timestamp"] = item[1]["received_timestamp"] = NOW_NS()
    return item


class Client(Mailed, _rclpy.Client):
    """A service client that counts, and takes from an inbox."""

    def __init__(self, node: Any, srv_type: Any, name: str, c_qos: Any) -> None:
        _Client.__init__(self, node, srv_type, name, deepened(c_qos))
        found = weakly(self, _Client.service_server_is_available)
        qos, kind, name = profile(c_qos), ros_type(srv_type), self.service_name
        self.outlet = Outlet(f"request {name}", kind, qos, lambda number: found() == bool(number))
        take = weakly(self, some(_Client.take_response), srv_type.Response)
        wire = f"response {name}"
        self.inbox = Inbox(wire, kind, qos, None, take, OFFICE.tally(wire))
        OFFICE.bell.hang("rcl_client_set_on_new_response_callback", self.pointer)
        self.register(self.outlet, self.inbox)

    def service_server_is_available(self) -> bool:
        """As in rclpy."""
        OFFICE.before_question()
        return bool(_Client.service_server_is_available(self))

    def send_request(self, request: Any) -> int:
        """Send and count."""
        OFFICE.before_send(self.outlet)
        number: int = _Client.send_request(self, request)
        OFFICE.after_send(self.outlet)
        return number

    def take_response(self, _: type) -> Any:
        """The oldest response in the inbox, or (None, None)."""
        return self.inbox.pop() or (None, None)


class Service(Mailed, _rclpy.Service):
    """A service that takes from an inbox, and counts."""

    def __init__(self, node: Any, srv_type: Any, name: str, c_qos: Any) -> None:
        _Service.__init__(self, node, srv_type, name, deepened(c_qos))
        qos, kind, name = profile(c_qos), ros_type(srv_type), self.name
        count = weakly(node, type(node).get_count_clients, name)
        take = weakly(self, some(_Service.service_take_request), srv_type.Request)
        wire = f"request {name}"
        self.inbox = Inbox(wire, kind, qos, lambda number: count() == number, take)
        self.outlet = Outlet(f"response {name}", kind, qos, None)
        OFFICE.bell.hang("rcl_service_set_on_new_request_callback", self.pointer)
        self.register(self.outlet, self.inbox)

    def service_take_request(self, _: type) -> Any:
        """The oldest request in the inbox, or (None, None)."""
        return self.inbox.pop() or (None, None)

    def service_send_response(self, response: Any, header: Any) -> None:
        """Send and count."""
        OFFICE.before_send(self.outlet)
        _Service.service_send_response(self, response, header)
        OFFICE.after_send(self.outlet)


def some(take: Callable[..., Any]) -> Callable[..., Any]:
    """Rclpy takes a pair, of two Nones if there is nothing; an inbox wants None then."""

    def taken(handle: Any, kind: type) -> Any:
        pair = take(handle, kind)
        return None if pair is None or pair[0] is None else pair

    return taken
