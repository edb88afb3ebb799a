"""What a cast needs of a run in real time: DDS carries what it hears, and the graph names it.

What records is a subscription, which counts as one: the program's graph shows its node.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any, Final

import rclpy
from rclpy.context import Context
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.qos import QoSDurabilityPolicy, QoSProfile, QoSReliabilityPolicy

from grader.run.lockstep.protocol import EndpointInfo
from grader.scenes.scene import STEP_NS

#: CastKeeper the cast's own nodes.
NAME: Final = "recorder"
#: How often the graph is read [ticks], and how many of its topics.
EVERY_TICKS, MOST_TOPICS = 5, 500
#: A message may reach another before us, which has logged that when we get it [ns].
LATE_NS = 500_000_000


class WallWire:
    """See `grader.scenes.cast.playing.Wire`.

    Attributes:
        node: that reads the graph, and records.
        ticks: of the run up to now.
        names: not known: DDS does not tell programs apart.
    """

    def __init__(self) -> None:
        self.node = _node(NAME, None)
        self.ticks = self._looks = 0
        self.names: dict[int, str] = {}
        self._began_ns = time.time_ns()
        self._heard_ns = 0
        self._served = set[str]()  # in this tick
        #: DDS has one type a topic for each process, unless it takes part several times
        self._others: list[Node] = []
        self._taps: list[tuple[str, str, Any]] = []

    def begin(self) -> None:
        """Note that the clock of the run starts now."""
        self._began_ns = time.time_ns()

    @property
    def now_ns(self) -> int:
        """The time from the start of the run [ns]."""
        return self.ticks * STEP_NS

    def tap(self, topic: str, kind: str, message: Any) -> None:
        """Record what the program publishes on a topic with a type, as well as it is offered."""
        offers = [each.qos_profile for each in self.node.get_publishers_info_by_topic(topic)]
        reliable, lasting = QoSReliabilityPolicy.RELIABLE, QoSDurabilityPolicy.TRANSIENT_LOCAL
        qos = QoSProfile(
            depth=1000,
            reliability=reliable
            if all(each.reliability == reliable for each in offers)
            else QoSReliabilityPolicy.BEST_EFFORT,
            durability=lasting
            if all(each.durability == lasting for each in offers)
            else QoSDurabilityPolicy.VOLATILE,
        )
        try:
            made = self.node.create_subscription(message, topic, print, qos, raw=True)
        except rclpy_implementation.RCLError:  # a peer has another type there
            self._others.append(_node(f"{NAME}_{len(self._others)}", _context()))
            made = self._others[-1].create_subscription(message, topic, print, qos, raw=True)
        self._taps.append((topic, kind, made))

    def heard(self) -> Iterator[tuple[str, str, int, bytes, int]]:
        now_ns = self.now_ns
        for topic, kind, tap in self._taps:
            while (found := tap.handle.take_message(tap.msg_type, True)) is not None:
                data, facts = found
                sent_ns = facts["source_timestamp"] - self._began_ns
                at_ns = min(max(sent_ns, self._heard_ns - LATE_NS, 0), now_ns)
                yield topic, kind, at_ns, bytes(data), 0
        self._heard_ns = now_ns

    def has_unread(self, node: str) -> bool:
        """Whether something may wait for a peer's node: once in a tick."""
        is_new = node not in self._served
        self._served.add(node)
        return is_new

    def endpoints(self, ours: set[str]) -> tuple[EndpointInfo, ...] | None:
        """Return what the program has; None in ticks in which nobody looks.

        Args:
            ours: names of nodes that are not the program's.
        """
        self._served.clear()
        self._looks += 1
        if self._looks % EVERY_TICKS:
            return None
        known = {*ours, *map(_called, (self.node, *self._others))}
        return tuple(sorted({each for each in self._graph() if each.node not in known}))

    def _graph(self) -> Iterator[EndpointInfo]:
        node = self.node
        for topic, _ in node.get_topic_names_and_types()[:MOST_TOPICS]:
            writers = node.get_publishers_info_by_topic(topic)
            for each in (*writers, *node.get_subscriptions_info_by_topic(topic)):
                qos, name = each.qos_profile, _joined(each.node_namespace, each.node_name)
                policies = (int(qos.reliability), int(qos.durability), max(0, qos.depth))
                writes = any(each is writer for writer in writers)
                kind = each.topic_type
                yield EndpointInfo(name, f"topic {topic}", kind, writes, *policies)
        for own, namespace in node.get_node_names_and_namespaces()[:MOST_TOPICS]:
            name = _joined(namespace, own)
            try:
                served = node.get_service_names_and_types_by_node(own, namespace)
                asked = node.get_client_names_and_types_by_node(own, namespace)
            except Exception:  # of rclpy: the node is gone meanwhile
                continue
            for writes, listed in ((False, served), (True, asked)):
                for service, kinds in listed:
                    yield EndpointInfo(name, f"request {service}", kinds[0], writes)


def _node(name: str, context: Context | None) -> Node:
    return Node(name, context=context, start_parameter_services=False, enable_rosout=False)


def _context() -> Context:
    made = Context()
    rclpy.init(args=[], context=made)
    return made


def _called(node: Node) -> str:
    return str(node.get_fully_qualified_name())


def _joined(namespace: str, name: str) -> str:
    return f"{namespace.rstrip('/')}/{name}"
