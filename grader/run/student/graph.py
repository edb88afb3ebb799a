"""Questions about the ROS graph: answered when DDS has found all that is there."""

from __future__ import annotations

import functools
from collections import Counter
from collections.abc import Sequence
from typing import Any

from grader.run.lockstep.faults import pass_on
from grader.run.student.simulator_link import SimulatorLink

QUESTIONS = (
    "count_clients",
    "count_publishers",
    "count_services",
    "count_subscribers",
    "get_client_names_and_types_by_node",
    "get_fully_qualified_node_names",
    "get_node_names",
    "get_node_names_and_namespaces",
    "get_node_names_and_namespaces_with_enclaves",
    "get_publisher_names_and_types_by_node",
    "get_publishers_info_by_topic",
    "get_service_names_and_types",
    "get_service_names_and_types_by_node",
    "get_subscriber_names_and_types_by_node",
    "get_subscriptions_info_by_topic",
    "get_topic_names_and_types",
)
#: A node's name and namespace.
Name = tuple[str, str]


def install(link: SimulatorLink, node_class: Any, nodes: Sequence[Name]) -> None:
    """Have a node's questions wait, in no virtual time, for the whole simulator to be found.

    Args:
        nodes: the simulator's.
    """
    seen_epochs: set[int] = set()

    def replace(name: str) -> None:
        ask = getattr(node_class, name)

        @functools.wraps(ask)
        def asked(self: Any, *args: Any, **kwargs: Any) -> Any:
            link.before_question()
            if link.graph_epoch not in seen_epochs:
                seen_epochs.add(link.graph_epoch)
                _await_graph(link, self.handle, nodes)
            return pass_on(ask, self, *args, **kwargs)

        setattr(node_class, name, asked)

    for question in QUESTIONS:
        if hasattr(node_class, question):
            replace(question)


def _await_graph(link: SimulatorLink, node: Any, nodes: Sequence[Name]) -> None:
    while not _is_complete(link, node, nodes):
        link.await_dds("graph")


def _is_complete(link: SimulatorLink, node: Any, nodes: Sequence[Name]) -> bool:
    """Whether DDS shows the simulator's nodes, and each of its endpoints with those of ours."""
    from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

    if not set(nodes) <= set(node.get_node_names_and_namespaces()):
        return False
    expected = Counter(
        [(r.channel, r.writes) for r in link.remotes.by_number.values()]
        + [(reader.channel, False) for reader in link.readers]
        + [(writer.channel, True) for writer in link.writers]
    )
    for (channel, writes), number in expected.items():
        kind, _, name = channel.partition(" ")
        if kind == "topic":
            count = node.get_count_publishers if writes else node.get_count_subscribers
        elif kind == "request" and not writes:
            count = node.get_count_services
        else:
            continue
        if count(name) != number:
            return False
    topics = {r.name for r in link.remotes.by_number.values() if r.writes and r.kind == "topic"}
    ask = _rclpy.rclpy_get_publisher_names_and_types_by_node
    return topics <= {topic for name in nodes for topic, _ in ask(node, False, *name)}
