"""rclpy's publishers, subscriptions, clients and services, whose messages go by our registry.

Each is a subclass of rclpy's own class in C++, put into its place in rclpy's extension module, so
that the Python of rclpy stays as it is. The entity in DDS is there as ever, and nobody asks it.
Used by both sides of the link.
"""

from __future__ import annotations

import importlib
import inspect
import sys
import weakref
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from typing import Any

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.qos import QoSProfile

from grader.ros import classes, handles
from grader.ros.definitions import Definitions, UncompiledPackages
from grader.ros.messages import deserialise, is_made, serialise
from grader.ros.uncompiled import KINDS
from grader.run.lockstep.faults import as_python_does, pass_on
from grader.run.lockstep.matching import (
    Arrived,
    Endpoint,
    EndpointRegistry,
    NodeEntry,
    Reader,
    Writer,
)
from grader.system import versions as system
from grader.text.message import msg

_Node = _rclpy.Node
_Publisher, _Subscription = _rclpy.Publisher, _rclpy.Subscription
_Client, _Service = _rclpy.Client, _rclpy.Service
_StateMachine = _rclpy.LifecycleStateMachine
_serialize, _deserialize = _rclpy.rclpy_serialize, _rclpy.rclpy_deserialize

REGISTRY: EndpointRegistry
#: Types of this process that the other has otherwise.
UNLIKE: set[str] = set()
#: Imports what is installed without compiled classes.
_UNCOMPILED = UncompiledPackages()
#: Interfaces that every node of rclpy's needs.
EVERY_NODE = ("rcl_interfaces", "type_description_interfaces")


def install(registry: EndpointRegistry) -> None:
    """Put the classes of this module into rclpy's extension module."""
    global REGISTRY
    REGISTRY = registry
    for kind in (Node, Publisher, Subscription, Client, Service, LifecycleStateMachine):
        setattr(_rclpy, kind.__name__, kind)
    _rclpy.rclpy_serialize = lambda message, kind: serialized(message)
    _rclpy.rclpy_deserialize = deserialized


def make_importable(texts: Mapping[str, str], unlike: Iterable[str] = ()) -> Definitions:
    """Have this process import classes of definitions; what is loaded already stays.

    Args:
        texts: a type's name, `my_interfaces/msg/Num` -> its definition.
        unlike: the names of those that the other process has otherwise: the two exchange nothing.
    """
    made = Definitions(texts)
    UNLIKE.update(unlike)
    _import_from(made)
    return made


def import_uncompiled() -> None:
    """Have this process import packages that are installed as definitions only."""
    if not system.is_ros_sourced() and _UNCOMPILED not in sys.meta_path:
        _import_from(_UNCOMPILED)


def _import_from(finder: Any) -> None:
    classes.make_support = handles.capsule
    sys.meta_path.insert(0, finder)  # a folder of the same name would be a package, too


def profile(c_qos: Any) -> QoSProfile:
    """Convert a C profile of rclpy's to its Python form."""
    return QoSProfile(**c_qos.to_dict())


def ros_type(python_type: type) -> str:
    """Return the ROS name of a message or service class: "geometry_msgs/msg/Twist"."""
    package, kind, *_ = python_type.__module__.split(".")
    name = python_type.__name__
    is_unlike = f"{package}/{kind}/{name.partition('_')[0]}" in UNLIKE
    return f"{package}/{kind}/{name}{' ' if is_unlike else ''}"  # a name that meets no other


def serialized(message: Any) -> bytes:
    """Serialise a message to CDR; a wrong one raises what rclpy's publish would."""
    kind = type(message)
    if is_made(kind):
        return bytes(pass_on(serialise, message))
    if kind._TYPE_SUPPORT is None:
        pass_on(kind.__import_type_support__)
    data: bytes = pass_on(_serialize, message, kind)
    return data


def deserialized(data: bytes, kind: Any) -> Any:
    """Deserialise a message of a class from CDR."""
    if is_made(kind):
        try:
            return deserialise(data, kind)
        except ValueError as error:
            as_python_does(_rclpy.RMWError(f"failed to deserialize ROS message: {error}"))
    if kind._TYPE_SUPPORT is None:
        kind.__import_type_support__()
    return pass_on(_deserialize, data, kind)


class Registered:
    """The base of our endpoint classes.

    Attributes:
        is_valid: whether rclpy is up; where it is not, rclpy's own methods raise the error.
    """

    endpoints: list[Endpoint]
    is_valid: Callable[[], bool]

    def register(self, node: Node, *endpoints: Endpoint) -> None:
        """Register the endpoints for as long as this object lives."""
        self.is_valid = node.is_valid
        self.endpoints = list(endpoints)
        for endpoint in endpoints:
            endpoint.node = node.get_fully_qualified_name()
            REGISTRY.add(endpoint)
        weakref.finalize(self, REGISTRY.remove, self.endpoints).atexit = False

    def connect(self, method: Callable[..., Any], *message: Any) -> None:
        """Connect the endpoints; where rclpy is down, call its method, which raises the error."""
        REGISTRY.connect()
        if not self.is_valid():
            pass_on(method, self, *message)

    def respond(self, writer: Writer, to: Any, response: Any) -> None:
        """Send the response to a request."""
        if not self.is_valid():
            as_python_does(_rclpy.RCLError("failed to send response: rclpy is shut down"))
        REGISTRY.respond(writer, to.request, serialized(response))

    def destroy_when_not_in_use(self) -> None:
        REGISTRY.remove(self.endpoints)
        super().destroy_when_not_in_use()  # type: ignore[misc]


class Node(Registered, _rclpy.Node):
    """A node that knows its context."""

    def __init__(self, name: str, namespace: str, context: Any, *more: Any) -> None:
        pass_on(_Node.__init__, self, name, namespace, context, *more)
        self.is_valid: Callable[[], bool] = context.ok
        channel = f"node {self.get_fully_qualified_name()}"
        self.register(self, NodeEntry(channel, "", QoSProfile(depth=10), logs=bool(more[-1])))


class Publisher(Registered, _rclpy.Publisher):
    """A publisher."""

    def __init__(self, node: Node, msg_type: type, topic: str, c_qos: Any, *more: Any) -> None:
        pass_on(_Publisher.__init__, self, node, msg_type, topic, c_qos, *more)
        channel = f"topic {self.get_topic_name()}"
        self.writer = Writer(channel, ros_type(msg_type), profile(c_qos), is_stream=True)
        self.register(node, self.writer)

    def get_subscription_count(self) -> int:
        if not self.is_valid():
            return int(pass_on(_Publisher.get_subscription_count, self))
        REGISTRY.before_question()
        return REGISTRY.count_readers(self.writer)

    def publish(self, message: Any) -> None:
        self.connect(_Publisher.publish, message)
        REGISTRY.publish(self.writer, serialized(message))

    def publish_raw(self, message: bytes) -> None:
        self.connect(_Publisher.publish_raw, message)
        REGISTRY.publish(self.writer, message)


class Subscription(Registered, _rclpy.Subscription):
    """A subscription that reads from our reader."""

    def __init__(self, node: Node, msg_type: type, topic: str, c_qos: Any, *more: Any) -> None:
        if more and more[0] is not None:  # a content filter, since rclpy 7.1.8
            self._refuse_filter()
        pass_on(_Subscription.__init__, self, node, msg_type, topic, c_qos, *more)
        channel = f"topic {self.get_topic_name()}"
        self.reader = Reader(channel, ros_type(msg_type), profile(c_qos), message=msg_type)
        self.register(node, self.reader)

    def get_publisher_count(self) -> int:
        if not self.is_valid():
            return int(pass_on(_Subscription.get_publisher_count, self))
        REGISTRY.before_question()
        return REGISTRY.count_writers(self.reader)

    def set_content_filter(self, *args: Any) -> None:
        self._refuse_filter()
        pass_on(_Subscription.set_content_filter, self, *args)

    def _refuse_filter(self) -> None:
        """Refuse content filters: we do not filter."""
        REGISTRY.refuse(msg("subscribes with a content filter"))

    def take_message(self, _: type, raw: bool) -> Any:
        """Return the oldest message in the reader with its info, or None."""
        while (item := self.reader.pop()) is not None:
            try:
                message = item.data if raw else deserialized(item.data, self.reader.message)
            except _rclpy.RMWError:  # somebody has published other bytes; DDS drops them
                continue
            return message, {
                "source_timestamp": item.time_ns,
                "received_timestamp": item.time_ns,
                "publication_sequence_number": item.number,
                "reception_sequence_number": None,
            }
        return None


class LifecycleStateMachine(Registered, _rclpy.LifecycleStateMachine):
    """A lifecycle node's states; rclpy's C++ publishes them, we only add the topic to the graph."""

    def __init__(self, node: Node, enable_communication_interface: bool) -> None:
        pass_on(_StateMachine.__init__, self, node, enable_communication_interface)
        if enable_communication_interface:
            name = _rclpy.rclpy_resolve_name(node, "~/transition_event", False, False)
            kind = "lifecycle_msgs/msg/TransitionEvent"
            self.register(node, Writer(f"topic {name}", kind, QoSProfile(depth=10)))


class RequestId(_rclpy.rmw_request_id_t):
    """The identity of a request and of its response; made by `request_id`."""

    sequence_number = 0  # rclpy's cannot be set
    request: Arrived


class RequestHeader(_rclpy.rmw_service_info_t):
    """The header of a request or a response of a service; made by `header`."""

    request_id: RequestId | None = None  # rclpy's cannot be set


def request_id(item: Arrived) -> RequestId:
    """Return the identity of an arrived request or response."""
    # rclpy's classes have no constructor
    made = RequestId.__new__(RequestId)
    made.sequence_number, made.request = item.number, item
    return made


def header(item: Arrived) -> RequestHeader:
    """Return the header of an arrived request or response."""
    made = RequestHeader.__new__(RequestHeader)
    made.request_id = request_id(item)
    return made


def pop(reader: Reader, identity: Callable[[Arrived], Any]) -> Any:
    """Return the oldest message after its identity; (None, None) if there is none."""
    item = reader.pop()
    if item is None:
        return None, None
    return identity(item), deserialized(item.data, reader.message)


class Client(Registered, _rclpy.Client):
    """A service client that reads from our reader."""

    def __init__(self, node: Node, srv_type: Any, name: str, c_qos: Any, *more: Any) -> None:
        pass_on(_Client.__init__, self, node, srv_type, name, c_qos, *more)
        qos, kind, name = profile(c_qos), ros_type(srv_type), self.service_name
        self.writer = Writer(f"request {name}", kind, qos)
        self.reader = Reader(f"response {name}", kind, qos, message=srv_type.Response)
        self.register(node, self.writer, self.reader)

    def service_server_is_available(self) -> bool:
        if not self.is_valid():
            return bool(pass_on(_Client.service_server_is_available, self))
        REGISTRY.before_question()
        return REGISTRY.count_readers(self.writer) > 0

    def send_request(self, request: Any) -> int:
        self.connect(_Client.send_request, request)
        return REGISTRY.ask(self.writer, self.reader, serialized(request))

    def take_response(self, _: type) -> Any:
        """Return the oldest response in the reader, or (None, None)."""
        return pop(self.reader, header)


class Service(Registered, _rclpy.Service):
    """A service that reads from our reader."""

    def __init__(self, node: Node, srv_type: Any, name: str, c_qos: Any, *more: Any) -> None:
        pass_on(_Service.__init__, self, node, srv_type, name, c_qos, *more)
        qos, kind, name = profile(c_qos), ros_type(srv_type), self.name
        self.reader = Reader(f"request {name}", kind, qos, message=srv_type.Request)
        self.writer = Writer(f"response {name}", kind, qos)
        self.register(node, self.reader, self.writer)

    def service_take_request(self, _: type) -> Any:
        """Return the oldest request in the reader, or (None, None)."""
        identity, request = pop(self.reader, header)
        return request, identity

    def service_send_response(self, response: Any, to: Any) -> None:
        self.respond(self.writer, to, response)


# What a fork server of either side imports beforehand ----------------------------------------


def import_messages(packages: Iterable[str]) -> None:
    """Import the interfaces of these packages that are installed, and load their type supports."""
    for package in (*EVERY_NODE, *packages):
        for kind in KINDS:
            with suppress(ImportError):
                _load(f"{package}.{kind}")
    _rclpy.rclpy_get_rmw_implementation_identifier()  # loads the middleware
    # rclpy's loggers ask for their caller, which looks up the file of every module, once
    inspect.getmodule(inspect.currentframe())


def _load(module: str) -> None:
    found = importlib.import_module(module)
    # those of classes that are made when they are asked for; a compiled package has no such list
    for value in [getattr(found, name) for name in getattr(found, "__all__", dir(found))]:
        if isinstance(value, type) and hasattr(value, "__import_type_support__"):
            value.__import_type_support__()
