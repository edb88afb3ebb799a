"""On which topics the submission publishes in real time: the usual mistake is a wrong name."""

from __future__ import annotations

from typing import Any

from grader.recording.recording import PublishedTopic

EVENTS = "/parameter_events"
#: Every node has these, and ROS publishes on them by itself.
USUAL = ("/rosout", EVENTS)
#: So many topics of the graph are looked at; each takes a while, in the middle of a run.
MOST_TOPICS = 500


class PublishedTopics:
    """Looks at the graph through a node of the scene, whose own publishers do not count."""

    def __init__(self, node: Any) -> None:
        self._node = node
        self._types: dict[str, str] = {}

    def look(self) -> None:
        """Note what the graph shows now."""
        node = self._node
        own = dict(
            node.get_publisher_names_and_types_by_node(node.get_name(), node.get_namespace())
        )
        for topic, types in node.get_topic_names_and_types()[:MOST_TOPICS]:
            others = node.count_publishers(topic) - (topic in own)
            if others > 0 and topic not in USUAL:
                self._types[topic] = types[0]

    def found(self) -> tuple[PublishedTopic, ...]:
        """What was noted."""
        return tuple(PublishedTopic(topic, kind) for topic, kind in sorted(self._types.items()))
