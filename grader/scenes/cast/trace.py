"""What a recording has of a cast: messages, and whatever else was exchanged with the program.

In a bag each topic is one of its real name and type; the rest is JSON on `/cast/events`, the last
of which says in which order messages were sent, and by which nodes.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Final, NamedTuple

from grader.recording.mcap import Channel
from grader.recording.subject import BagMessage, OneTrace
from grader.ros.bag_types import BagTypes
from grader.ros.cdr import string, string_of
from grader.scenes.scene import STEP_NS
from grader.system import strict_json

EVENTS, STRING = "/cast/events", "std_msgs/msg/String"
#: The type of transforms.
TF: Final = "tf2_msgs/msg/TFMessage"
ROSOUT: Final = "/rosout"
#: As DDS numbers it.
TRANSIENT_LOCAL: Final = 1


class SentMessage(NamedTuple):
    """A message on a topic.

    Attributes:
        time_ns: when it was sent, from the start of the run.
        node: that sent it, with its namespace; '' where several of the program's may have.
        data: in CDR, with zeros between fields.
    """

    time_ns: int
    topic: str
    type: str
    node: str
    data: bytes


#: Plain data with a `kind` and a `time_ns`; `grader.scenes.cast.recorder` says which there are.
Event = Mapping[str, Any]


@dataclass(frozen=True)
class CastTrace(OneTrace):
    """What was exchanged in a run.

    Attributes:
        peers: the nodes of the cast, with their namespaces.
        definitions: the definitions of all types in it, and of those of their fields.
        programs: whose a node is, as `ros2 launch` calls it, where there are several.
    """

    ticks: int = 0
    messages: tuple[SentMessage, ...] = ()
    events: tuple[Event, ...] = field(default=(), hash=False)
    peers: tuple[str, ...] = ()
    definitions: Mapping[str, str] = field(default_factory=dict, hash=False)
    programs: Mapping[str, str] = field(default_factory=dict, hash=False)

    @property
    def duration_ns(self) -> int:
        return self.ticks * STEP_NS

    def sha256(self) -> str:
        """A hash of all that was exchanged; where types come from, and programs, do not count."""
        made = hashlib.sha256(_json([self.ticks, self.peers, self.events]).encode())
        for message in self.messages:
            made.update(repr(message).encode())
        return made.hexdigest()

    # What checks ask --------------------------------------------------------------------------

    def of_kind(self, kind: str, **values: Any) -> list[Event]:
        """Return the events of a kind with these values."""
        return [
            event
            for event in self.events
            if event["kind"] == kind and all(event.get(k) == v for k, v in values.items())
        ]

    def sent(self, topic: str, *, by_peers: bool = False) -> list[SentMessage]:
        """Return the messages of a topic: the program's, or the peers'."""
        own = [each for each in self.messages if each.topic == topic]
        return [each for each in own if self.is_peer(each) == by_peers]

    def transforms(self, topic: str) -> list[tuple[int, Any]]:
        """Return the program's transforms on a topic, each with when it was sent [ns]."""
        return [
            (sent.time_ns, each)
            for sent in self.sent(topic)
            if sent.type == TF
            for each in self.values(sent)["transforms"]
        ]

    def readers(self, topic: str, kind: str = "") -> list[Event]:
        """Return the program's subscriptions of a topic, of any type or this one."""
        found = self._readers.get(f"topic {topic}", [])
        return [each for each in found if kind in ("", each["type"])]

    def is_heard(self, message: SentMessage) -> bool:
        """Whether the program had a subscription of its type then; of a latched topic, any time."""
        readers = self.readers(message.topic, message.type)
        is_latched = any(each["durability"] == TRANSIENT_LOCAL for each in readers)
        return is_latched or any(each["time_ns"] <= message.time_ns for each in readers)

    def is_peer(self, message: SentMessage) -> bool:
        return message.node in self.peers

    def values(self, message: SentMessage) -> Any:
        """Return the values of a message as plain data: objects with fields, lists, numbers."""
        return self._types.values(message.data, message.type)

    @cached_property
    def topics_of_peers(self) -> set[str]:
        """The topics on which peers publish, whether or not anything was recorded of them."""
        offered = {each["name"] for each in self.of_kind("offers", what="publisher")}
        return offered | {each.topic for each in self.messages if self.is_peer(each)}

    @cached_property
    def _readers(self) -> Mapping[str, list[Event]]:
        found: dict[str, list[Event]] = {}
        for event in self.of_kind("endpoint", writes=False):
            found.setdefault(event["channel"], []).append(event)
        return found

    @cached_property
    def _types(self) -> BagTypes:
        return BagTypes(self.definitions)


# A bag ----------------------------------------------------------------------------------------


def to_messages(trace: CastTrace) -> list[BagMessage]:
    topics, nodes = dict[str, int](), dict[str, int]()  # -> their numbers
    order = [
        [topics.setdefault(each.topic, len(topics)), nodes.setdefault(each.node, len(nodes))]
        for each in trace.messages
    ]
    facts = {"topics": [*topics], "nodes": [*nodes], "order": order, "peers": trace.peers}
    last = {"definitions": trace.definitions, "programs": trace.programs, **facts}
    made = [BagMessage(m.time_ns, m.topic, m.type, m.data) for m in trace.messages]
    made += [BagMessage(e["time_ns"], EVENTS, STRING, string(_json(e))) for e in trace.events]
    made.append(BagMessage(trace.duration_ns, EVENTS, STRING, string(_json(last))))
    return sorted(made, key=lambda message: message.time_ns)


#: What each kind of event has from the start, and of which type each value is.
OBLIGATORY: Final[Mapping[str, tuple[str, ...]]] = {
    "offers": ("node", "what", "name", "type"),
    "endpoint": ("node", "channel", "type", "writes", "reliability", "durability", "depth"),
    "call": ("peer", "id", "service", "type"),
    "served": ("peer", "service", "request"),
    "goal": ("peer", "id", "action", "type"),
    "action": ("peer", "action", "goal", "accepted", "feedback"),
    "parameter": ("peer", "id", "node"),
    "got": ("peer", "topic", "values"),
    "refused": ("peer", "what", "why"),
    "unsaid": ("peer", "what", "why"),
    "full": (),
}
_TYPES: Final[Mapping[str, type | tuple[type, ...]]] = {
    **dict.fromkeys(("node", "what", "name", "type", "channel", "peer", "id"), str),
    **dict.fromkeys(("service", "action", "topic", "status"), str),
    **dict.fromkeys(("reliability", "durability", "depth"), int),
    **dict.fromkeys(("time_ns", "sent_ns", "answered_ns", "ended_ns"), int),
    **dict.fromkeys(("request", "response", "goal", "result", "set", "values"), dict),
    **{"writes": bool, "accepted": bool, "feedback": list, "why": (str, dict, list)},
}


def _checked(event: Any) -> Event:
    """Return an event; raise ValueError for what no recorder writes."""
    if not isinstance(event, dict) or event.get("kind") not in OBLIGATORY:
        raise ValueError(f"no event: {event!r:.100}")
    needed = [*OBLIGATORY[event["kind"]], "time_ns"]
    needed += ["feedback"] if event["kind"] == "goal" and "sent_ns" in event else []
    wrong = [n for n, value in event.items() if not isinstance(value, _TYPES.get(n, object))]
    if wrong or not event.keys() >= {*needed}:
        raise ValueError(f"an event with other values: {event!r:.100}")
    for each in event.get("feedback", ()):
        if not (isinstance(each, list) and len(each) == 2 and isinstance(each[0], int)):
            raise ValueError(f"an event with other feedback: {each!r:.100}")
    return event


def from_channels(channels: Sequence[Channel], duration_ns: int) -> CastTrace:
    by_topic = {channel.topic: channel for channel in channels}
    *listed, last = (strict_json.loads(string_of(e)) for e in by_topic.pop(EVENTS).messages())
    events = [_checked(event) for event in listed]
    kept: dict[str, Iterator[tuple[int, bytes]]] = {
        topic: iter(list(zip(channel.times_ns.tolist(), channel.messages(), strict=True)))
        for topic, channel in by_topic.items()
    }
    messages = []
    for topic_number, node_number in last["order"]:
        topic = last["topics"][topic_number]
        time_ns, data = next(kept[topic])
        kind = by_topic[topic].msgtype
        messages.append(SentMessage(time_ns, topic, kind, last["nodes"][node_number], data))
    ticks, peers = duration_ns // STEP_NS, tuple(last["peers"])
    more = last["definitions"], last.get("programs", {})
    return CastTrace(ticks, tuple(messages), tuple(events), peers, *more)


def _json(data: Any) -> str:
    return json.dumps(data, separators=(",", ":"), sort_keys=True, allow_nan=False)
