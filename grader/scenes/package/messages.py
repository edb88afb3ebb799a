"""A trace as the one message of a bag: a std_msgs/String with its JSON, at tick 0."""

from __future__ import annotations

from collections.abc import Sequence
from types import SimpleNamespace
from typing import Final

from grader.scenes.message_types import types_of
from grader.scenes.package.trace import PackageTrace, decode, encode
from grader.scenes.scene import Message

TOPIC: Final = "/package"
TYPE: Final = "std_msgs/msg/String"
DEFINITIONS: Final = {TYPE: "string data\n"}


def to_messages(trace: PackageTrace) -> list[Message]:
    """A trace as messages."""
    text = encode(trace).decode("ascii")
    return [Message(0, TOPIC, TYPE, types_of(DEFINITIONS).types[TYPE](data=text))]


def from_messages(found: Sequence[Message]) -> PackageTrace:
    """The trace of a bag's messages.

    Raises:
        ValueError, AttributeError: they are not from `to_messages`.
    """
    if [(each.tick, each.topic, each.msgtype) for each in found] != [(0, TOPIC, TYPE)]:
        raise ValueError(f"expected one message on {TOPIC}, found {len(found)} messages")
    message: SimpleNamespace = found[0].message
    return decode(str(message.data).encode("ascii"))
