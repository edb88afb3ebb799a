"""A trace as the one message of a bag: a std_msgs/String with its JSON, at tick 0."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

from grader.scenes.cdr import string, string_of
from grader.scenes.channel import Channel
from grader.scenes.package.trace import PackageTrace, decode, encode
from grader.scenes.scene import Message

TOPIC: Final = "/package"
TYPE: Final = "std_msgs/msg/String"
DEFINITIONS: Final = {TYPE: "string data\n"}


def to_messages(trace: PackageTrace) -> list[Message]:
    """A trace as messages."""
    return [Message(0, TOPIC, TYPE, string(encode(trace).decode("ascii")))]


def from_channels(channels: Sequence[Channel]) -> PackageTrace:
    """The trace of a bag's channels.

    Raises:
        ValueError: they are not from `to_messages`.
    """
    found = [(each.topic, each.msgtype, each.ticks.tolist()) for each in channels]
    if found != [(TOPIC, TYPE, [0])]:
        raise ValueError(f"expected one message on {TOPIC}, found {found!r:.80}")
    return decode(string_of(next(channels[0].messages())).encode("ascii"))
