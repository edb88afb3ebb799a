"""A trace as the one message of a bag: a std_msgs/String with its JSON, at tick 0."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

from grader.scenes.channel import Channel
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


def from_channels(channels: Sequence[Channel]) -> PackageTrace:
    """The trace of a bag's channels.

    Raises:
        ValueError: they are not from `to_messages`.
        rosbags.serde.SerdeError: the message cannot be read.
    """
    found = [(each.topic, each.msgtype, each.ticks.tolist()) for each in channels]
    if found != [(TOPIC, TYPE, [0])]:
        raise ValueError(f"expected one message on {TOPIC}, found {found!r:.80}")
    message: Any = types_of(DEFINITIONS).deserialize_cdr(next(channels[0].messages()), TYPE)
    return decode(str(message.data).encode("ascii"))
