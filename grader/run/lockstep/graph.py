"""Answers what a program asks of the graph from the tables of the link.

DDS learns of others when it likes, and forgets one that died after a while only. What is asked
here is what all processes have at that moment, in the same order every time. Put into rclpy's
extension module, so that the Python of rclpy stays as it is. As from DDS, the depth of a queue is
not told; unlike there, the hash of a type is not either.
"""

from __future__ import annotations

import functools
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from rclpy.duration import Infinite
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.qos import QoSDurabilityPolicy, QoSHistoryPolicy, QoSProfile
from rclpy.topic_endpoint_info import TopicEndpointTypeEnum

from grader.run.lockstep import endpoints
from grader.run.lockstep.faults import as_python_does
from grader.run.lockstep.matching import Endpoint, NodeEntry, Reader, Writer

#: A service that rclpy's C++ makes for a node by itself.
DESCRIPTION = ("get_type_description", "type_description_interfaces/srv/GetTypeDescription")
#: What is between an action's name and that of the topic by which it is known, and after its type.
FEEDBACK, FEEDBACK_TYPE = "/_action/feedback", "_FeedbackMessage"

NamesAndTypes = list[tuple[str, list[str]]]


def install() -> None:
    """Put the functions of this module into rclpy's extension module, after `endpoints`."""
    mangled = _rclpy.rclpy_get_topic_names_and_types
    functions: dict[str, Callable[..., Any]] = {
        "publishers_info_by_topic": _info(True),
        "subscriptions_info_by_topic": _info(False),
        "topic_names_and_types": lambda node, no_demangle: (
            mangled(node, True) if no_demangle else _names(_seen("topic"))
        ),
        "service_names_and_types": lambda node: _names(_seen("request")),
    }
    for which, kind, writes in _KINDS:
        functions[f"{which}_names_and_types_by_node"] = _by_node(which, kind, writes)
    for name, answer in functions.items():
        setattr(_rclpy, f"rclpy_get_{name}", _question(answer))
    for name, answer in _METHODS.items():
        setattr(endpoints.Node, f"get_{name}", _question(answer))


def _question(answer: Callable[..., Any]) -> Callable[..., Any]:
    """Return the function that rclpy calls: it looks at the tables as they are now."""

    @functools.wraps(answer)
    def asked(*words: Any) -> Any:
        endpoints.REGISTRY.before_question()
        return answer(*words)

    return asked


def _nodes() -> list[tuple[str, str]]:
    """Return the names and namespaces of all nodes, in the order in which they were made."""
    return [_split(each.name) for each in _all() if isinstance(each, NodeEntry)]


def _all() -> Iterator[Endpoint]:
    registry = endpoints.REGISTRY
    both = sorted({**registry.own, **registry.others}.items())
    return (each for _, each in both if not each.is_hidden)


def _seen(kind: str, writes: bool | None = None, node: str = "") -> Iterator[Endpoint]:
    """Yield the readers and writers of a kind of channel; of a node alone, where one is given."""
    for each in _everything():
        is_of_side = writes in (None, isinstance(each, Writer))
        if each.kind == kind and is_of_side and node in ("", each.node):
            yield each


def _everything() -> Iterator[Endpoint]:
    for each in _all():
        if not isinstance(each, NodeEntry):
            yield each
            continue
        if each.logs:
            yield log_writer(each.name)
        if hasattr(_rclpy, "TypeDescriptionService"):
            name, kind = DESCRIPTION
            yield Reader(f"request {each.name}/{name}", kind, QoSProfile(depth=10), node=each.name)


def log_writer(node: str) -> Writer:
    """Return the writer on /rosout of a node."""
    qos = QoSProfile(depth=1000, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)
    return Writer("topic /rosout", "rcl_interfaces/msg/Log", qos, node=node, is_stream=True)


def _names(found: Iterable[Endpoint]) -> NamesAndTypes:
    types: dict[str, set[str]] = defaultdict(set)
    for each in found:
        types[each.name].add(each.type.rstrip())
    return [(name, sorted(types[name])) for name in sorted(types)]


def _split(full: str) -> tuple[str, str]:
    space, _, name = full.rpartition("/")
    return name, space or "/"


# Of one node ----------------------------------------------------------------------------------

_KINDS = (
    *(("publisher", "topic", True), ("subscriber", "topic", False)),
    *(("service", "request", False), ("client", "request", True)),
)


def _by_node(which: str, kind: str, writes: bool) -> Callable[..., NamesAndTypes]:
    def of_node(node: Any, *words: Any) -> NamesAndTypes:
        *_, name, space = words  # before them, of a topic: no_demangle
        return _names(_seen(kind, writes, _known(which, name, space)))

    return of_node


def _known(which: str, name: str, space: str) -> str:
    """Return the full name of a node, which must be there."""
    if (name, space) not in _nodes():
        words = f"cannot get {which} names and types for nonexistent node: error not set"
        as_python_does(_rclpy.NodeNameNonExistentError(words))
    return f"{space.rstrip('/')}/{name}"


# A node's methods -----------------------------------------------------------------------------


def _count(kind: str, writes: bool) -> Callable[[Any, str], int]:
    return lambda node, name: sum(each.name == name for each in _seen(kind, writes))


def _actions(writes: bool | None = None) -> Callable[..., NamesAndTypes]:
    """Return the method for actions: those with a client hear feedback, with a server send it."""

    def actions(self: Any, *of: str) -> NamesAndTypes:
        node = _known("action", *of) if of else ""
        return [
            (name.removesuffix(FEEDBACK), [kind.removesuffix(FEEDBACK_TYPE) for kind in types])
            for name, types in _names(_seen("topic", writes, node))
            if name.endswith(FEEDBACK)
        ]

    return actions


_METHODS: dict[str, Callable[..., Any]] = {
    "node_names_and_namespaces": lambda self: _nodes(),
    "node_names_and_namespaces_with_enclaves": lambda self: [(*each, "/") for each in _nodes()],
    "count_publishers": _count("topic", True),
    "count_subscribers": _count("topic", False),
    "count_clients": _count("request", True),
    "count_services": _count("request", False),
    "action_names_and_types": _actions(),
    "action_client_names_and_types_by_node": _actions(False),
    "action_server_names_and_types_by_node": _actions(True),
}


# Of one topic ---------------------------------------------------------------------------------


def _info(writes: bool) -> Callable[..., list[dict[str, Any]]]:
    def info(node: Any, topic: str, no_mangle: bool) -> list[dict[str, Any]]:
        found = (each for each in _seen("topic", writes) if each.name == topic)
        return [_described(each) for each in found]

    return info


def _described(seen: Endpoint) -> dict[str, Any]:
    """Return what the graph tells of a publisher or subscription, as rclpy's C++ does."""
    name, space = _split(seen.node)
    writes = isinstance(seen, Writer)
    kind = TopicEndpointTypeEnum.PUBLISHER if writes else TopicEndpointTypeEnum.SUBSCRIPTION
    return {
        "node_name": name,
        "node_namespace": space,
        "topic_type": seen.type.rstrip(),
        "endpoint_type": int(kind),
        "endpoint_gid": list(seen.number.to_bytes(16, "big")),
        "qos_profile": {
            **{"depth": 0, "history": int(QoSHistoryPolicy.UNKNOWN)},
            "reliability": int(seen.qos.reliability),
            "durability": 1 if seen.is_lasting else 2,
            **{"lifespan": Infinite, "deadline": Infinite, "liveliness": 1},
            **{"liveliness_lease_duration": Infinite, "avoid_ros_namespace_conventions": False},
        },
    }
