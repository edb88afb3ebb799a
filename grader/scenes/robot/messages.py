"""A trace as ROS messages, and back.

| topic | type | one message is |
|---|---|---|
| /joint_states | sensor_msgs/msg/JointState | what the submission published |
| /tf, /tf_static | tf2_msgs/msg/TFMessage | what it or the scene published |
| /robot_description | std_msgs/msg/String | the robot's URDF |
| /robot/publishers | std_msgs/msg/String | at the end: of each topic, who published which message: `r` the scene, as robot_state_publisher, `s` the submission; as JSON |
"""  # noqa: E501

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from grader.scenes.cdr import string, string_of
from grader.scenes.channel import Channel
from grader.scenes.robot.decoding import STRING
from grader.scenes.robot.trace import TOPICS, Heard, Publisher, RobotTrace, check, json_facts
from grader.scenes.scene import Message

PUBLISHERS = "/robot/publishers"
LETTERS: dict[str, Publisher] = {"r": "scene", "s": "submission"}


def to_messages(trace: RobotTrace) -> list[Message]:
    """All messages in their order, which is by tick; who published them comes last."""
    found: list[Message] = [
        Message(tick, topic, TOPICS[topic], data) for tick, topic, _, data in trace.messages
    ]
    last = max([trace.ticks, *(message.tick for message in found[-1:])])
    return [*found, Message(last, PUBLISHERS, STRING, string(json_facts(trace)))]


def from_channels(channels: Sequence[Channel], ticks: int) -> RobotTrace:
    """The trace that a bag's channels say, each of them with a topic of its own.

    Raises:
        ValueError, KeyError, TypeError: they are not what `to_messages` makes.
    """
    by_topic = {channel.topic: channel for channel in channels}
    said = _publishers(by_topic.pop(PUBLISHERS))
    found: list[tuple[int, Heard]] = []
    for topic, channel in by_topic.items():
        if channel.msgtype != TOPICS[topic]:
            raise ValueError(f"{topic}: expected a {TOPICS[topic]}, found a {channel.msgtype}")
        each = zip(
            *(channel.places.tolist(), channel.ticks.tolist(), said[topic], channel.messages()),
            strict=True,
        )
        found += [(n, Heard(tick, topic, LETTERS[who], data)) for n, tick, who, data in each]
    trace = RobotTrace(ticks, tuple(heard for _, heard in sorted(found, key=lambda one: one[0])))
    check(trace)
    return trace


def _publishers(channel: Channel) -> dict[str, str]:
    if channel.msgtype != STRING or len(channel) != 1:
        found = f"{len(channel)} of {channel.msgtype}"
        raise ValueError(f"{PUBLISHERS}: expected one {STRING}, found {found}")
    said: Any = json.loads(string_of(next(channel.messages())))
    if not isinstance(said, dict) or not all(isinstance(each, str) for each in said.values()):
        raise ValueError(f"{PUBLISHERS}: expected topics with letters, found {said!r:.80}")
    return said
