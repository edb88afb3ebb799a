"""What a run of the scene leaves: every message on the robot's topics, recorded, and in a bag.

| topic | type | one message is |
|---|---|---|
| /joint_states | sensor_msgs/msg/JointState | what the submission published |
| /tf, /tf_static | tf2_msgs/msg/TFMessage | what it or the scene published |
| /robot_description | std_msgs/msg/String | the robot's URDF |
| /robot/publishers | std_msgs/msg/String | at the end: of each topic, who published which message: `r` the scene, as robot_state_publisher, `s` the submission; as JSON |
"""  # noqa: E501

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final, Literal, NamedTuple

from grader.recording import BagMessage, BagTypes, Channel, OneTrace, string, string_of
from grader.text import Message, msg
from grader_robots.robot_py.robot_state import JointState, Placed, Robot, RobotState

JOINT_STATE, TF_MESSAGE = "sensor_msgs/msg/JointState", "tf2_msgs/msg/TFMessage"
STRING = "std_msgs/msg/String"
TYPES: Final = BagTypes({})

TICK_NS = 16_000_000
TICK_S = TICK_NS / 1e9

JOINT_STATES, TF, TF_STATIC = "/joint_states", "/tf", "/tf_static"
DESCRIPTION = "/robot_description"
#: Every topic of the scene, with its type.
TOPICS = {JOINT_STATES: JOINT_STATE, TF: TF_MESSAGE, TF_STATIC: TF_MESSAGE, DESCRIPTION: STRING}

Publisher = Literal["scene", "submission"]
PUBLISHERS = "/robot/publishers"
LETTERS: dict[str, Publisher] = {"r": "scene", "s": "submission"}

#: Messages of a run, and their bytes: far above what moves a robot.
MOST_MESSAGES, MOST_BYTES = 20_000, 20_000_000
_NOT_ALL = msg(
    "of the node's messages the first {number}, or {megabytes} MB, were taken",
    number=MOST_MESSAGES,
    megabytes=MOST_BYTES // 10**6,
)


class HeardJointState(NamedTuple):
    """A JointState message.

    Attributes:
        positions: [rad or m]; may be of another length than `names`, and hold anything.
    """

    tick: int
    stamp_ns: int
    names: tuple[str, ...]
    positions: tuple[float, ...]

    @property
    def is_taken(self) -> bool:
        return len(self.names) == len(self.positions)


class Transform(NamedTuple):
    """A TransformStamped.

    Attributes:
        message: which of the trace's messages it stands in.
        topic, publisher: as in the trace.
        parent, child: the frames, as they were sent.
        translation: x, y, z [m].
        rotation: the quaternion x, y, z, w.
    """

    tick: int
    message: int
    topic: str
    publisher: str
    stamp_ns: int
    parent: str
    child: str
    translation: tuple[float, float, float]
    rotation: tuple[float, float, float, float]


class Heard(NamedTuple):
    """A message.

    Attributes:
        tick: in which it was published.
        publisher: the scene itself, or the submission.
        data: in little-endian CDR.
    """

    tick: int
    topic: str
    publisher: Publisher
    data: bytes


@dataclass(frozen=True, eq=False)
class RobotTrace(OneTrace):
    """A recorded run.

    Attributes:
        ticks: how many were recorded, of 16 ms each.
        messages: in the order in which they came.
    """

    ticks: int
    messages: tuple[Heard, ...] = ()

    @property
    def duration_ns(self) -> int:
        """How long was recorded [ns]."""
        return self.ticks * TICK_NS

    def on(self, topic: str, publisher: Publisher = "submission") -> Sequence[Heard]:
        """What somebody published on a topic."""
        return [m for m in self.messages if (m.topic, m.publisher) == (topic, publisher)]

    @cached_property
    def description(self) -> str:
        """The URDF that the scene published; '' where nothing was recorded."""
        found = self.on(DESCRIPTION, "scene")
        return string_of(found[0].data) if found else ""

    @cached_property
    def robot(self) -> Robot | None:
        """What the description says; None where there is none."""
        return Robot.of(self.description) if self.description else None

    @cached_property
    def joint_states(self) -> tuple[HeardJointState, ...]:
        """The joint states that the submission published."""
        return tuple(_joint_state(m.tick, m.data) for m in self.on(JOINT_STATES))

    @cached_property
    def transforms(self) -> tuple[Transform, ...]:
        """All transforms on /tf and /tf_static, whoever sent them."""
        return tuple(
            transform
            for number, m in enumerate(self.messages)
            if m.topic in (TF, TF_STATIC)
            for transform in _transforms(m.tick, m.data, number, m.topic, m.publisher)
        )

    def sha256(self) -> str:
        """A hash of every message; equal hashes mean equal runs."""
        digest = hashlib.sha256()
        for tick, topic, publisher, data in self.messages:
            digest.update(f"{tick} {topic} {publisher} {len(data)} ".encode())
            digest.update(data)
        return digest.hexdigest()


class RobotRecorder:
    """Records what is published, and knows what robot_state_publisher answers.

    What the scene has published itself it knows when it is heard again.

    Attributes:
        ticks: how many have been recorded.
        heard: messages of the submission's.
        flags: what of them was not taken.
    """

    def __init__(self, description: str) -> None:
        self._state = RobotState(Robot.of(description))
        self.ticks = 0
        self.heard = 0
        self.flags: tuple[Message, ...] = ()
        self._messages: list[Heard] = []
        self._bytes = 0
        self._own: Counter[tuple[str, bytes]] = Counter()

    def publishes(self, topic: str, data: bytes) -> None:
        """The scene publishes a message, and will hear it as anybody's."""
        self._own[topic, data] += 1
        self._messages.append(Heard(self.ticks + 1, topic, "scene", data))

    def hears(self, topic: str, data: bytes) -> bool:
        """A message is heard; whether it is the submission's, and taken."""
        if self._own[topic, data]:
            self._own[topic, data] -= 1
            return False
        self.heard += 1
        self._bytes += len(data)
        if self.heard > MOST_MESSAGES or self._bytes > MOST_BYTES:
            self.flags = (_NOT_ALL,)
            return False
        self._messages.append(Heard(self.ticks + 1, topic, "submission", data))
        return True

    def answer(self, topic: str, data: bytes, now_ns: int) -> Sequence[Placed] | None:
        """What robot_state_publisher sends on /tf when a message is heard; None: nothing."""
        if not self.hears(topic, data) or topic != JOINT_STATES:
            return None
        names = _joint_state(0, data)
        state = JointState(names.stamp_ns, names.names, names.positions)
        return self._state.hear(state, now_ns).transforms

    def fixed(self, now_ns: int) -> Sequence[Placed]:
        """What robot_state_publisher sends on /tf_static, once."""
        return self._state.robot.fixed("", now_ns)

    def trace(self) -> RobotTrace:
        return RobotTrace(self.ticks, tuple(self._messages))


def to_messages(trace: RobotTrace) -> list[BagMessage]:
    """All messages in their order, which is by time; who published them comes last."""
    found: list[BagMessage] = [
        BagMessage(tick * TICK_NS, topic, TOPICS[topic], data)
        for tick, topic, _, data in trace.messages
    ]
    last = max([trace.duration_ns, *(message.time_ns for message in found[-1:])])
    letters = {publisher: letter for letter, publisher in LETTERS.items()}
    names = {
        topic: "".join(letters[m.publisher] for m in trace.messages if m.topic == topic)
        for topic in TOPICS
    }
    return [*found, BagMessage(last, PUBLISHERS, STRING, string(json.dumps(names)))]


def from_channels(channels: Sequence[Channel], ticks: int) -> RobotTrace:
    """The trace that a bag's channels say, each of them with a topic of its own."""
    by_topic = {channel.topic: channel for channel in channels}
    names = _publishers(by_topic.pop(PUBLISHERS))
    found: list[tuple[int, Heard]] = []
    for topic, channel in by_topic.items():
        if channel.msgtype != TOPICS[topic]:
            raise ValueError(f"{topic}: expected a {TOPICS[topic]}, found a {channel.msgtype}")
        heard_at = channel.times_ns // TICK_NS
        each = zip(
            *(channel.places.tolist(), heard_at.tolist(), names[topic], channel.messages()),
            strict=True,
        )
        found += [(n, Heard(tick, topic, LETTERS[who], data)) for n, tick, who, data in each]
    trace = RobotTrace(ticks, tuple(heard for _, heard in sorted(found, key=lambda one: one[0])))
    _check(trace)
    return trace


def _publishers(channel: Channel) -> dict[str, str]:
    if channel.msgtype != STRING or len(channel) != 1:
        found = f"{len(channel)} of {channel.msgtype}"
        raise ValueError(f"{PUBLISHERS}: expected one {STRING}, found {found}")
    names: Any = json.loads(string_of(next(channel.messages())))
    if not isinstance(names, dict) or not all(isinstance(each, str) for each in names.values()):
        raise ValueError(f"{PUBLISHERS}: expected topics with letters, found {names!r:.80}")
    return names


def _check(trace: RobotTrace) -> None:
    """See whether a trace that comes from outside can be one."""
    before = 0
    for tick, topic, _, data in trace.messages:
        # what comes after the last tick would have taken effect in the next one
        if not before <= tick <= trace.ticks + 1:
            raise ValueError(f"{topic}: a message at tick {tick} of {trace.ticks}")
        before = tick
        TYPES.values(data, TOPICS[topic])


def _joint_state(tick: int, data: bytes) -> HeardJointState:
    """A sensor_msgs/JointState."""
    found = TYPES.values(data, JOINT_STATE)
    names, positions = tuple(found["name"]), tuple(found["position"])
    return HeardJointState(tick, _stamp_ns(found), names, positions)


def _transforms(tick: int, data: bytes, number: int, topic: str, publisher: str) -> list[Transform]:
    """Those of a tf2_msgs/TFMessage."""
    made = []
    for found in TYPES.values(data, TF_MESSAGE)["transforms"]:
        sent = tick, number, topic, publisher, _stamp_ns(found)
        frames = found["header"]["frame_id"], found["child_frame_id"]
        moved, turned = (tuple(part.values()) for part in found["transform"].values())
        made.append(Transform(*sent, *frames, moved, turned))
    return made


def _stamp_ns(found: Mapping[str, Any]) -> int:
    stamp = found["header"]["stamp"]
    return int(stamp["sec"]) * 1_000_000_000 + int(stamp["nanosec"])
