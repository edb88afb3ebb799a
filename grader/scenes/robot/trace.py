"""What a run of the scene leaves: every message on the robot's topics, with tick and publisher."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple, Self

from grader.scenes.cdr import string_of
from grader.scenes.robot import decoding
from grader.scenes.robot.decoding import JointStates, Transform
from grader.scenes.scene import Trace
from robot_py.robot_state import Robot

TICK_NS = 16_000_000
TICK_S = TICK_NS / 1e9

JOINT_STATES, TF, TF_STATIC = "/joint_states", "/tf", "/tf_static"
DESCRIPTION = "/robot_description"
#: Every topic of the scene, with its type.
TOPICS = {
    JOINT_STATES: "sensor_msgs/msg/JointState",
    TF: "tf2_msgs/msg/TFMessage",
    TF_STATIC: "tf2_msgs/msg/TFMessage",
    DESCRIPTION: "std_msgs/msg/String",
}

Publisher = Literal["scene", "submission"]


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
class RobotTrace:
    """A recorded run.

    Attributes:
        ticks: how many were recorded, of 16 ms each.
        messages: in the order in which they came.
    """

    ticks: int
    messages: tuple[Heard, ...] = ()

    @classmethod
    def of(cls, trace: Trace) -> Self:
        """A recording's trace as what it is.

        Raises:
            TypeError: it is another scene's.
        """
        if not isinstance(trace, cls):
            raise TypeError(f"expected a trace of a robot, found a {type(trace).__name__}")
        return trace

    @property
    def simulated_s(self) -> float:
        """How long was recorded [s]."""
        return round(self.ticks * TICK_S, 3)

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
        """What the description says; None where there is none.

        Raises:
            RefusedDescription (of robot_py): no exercise has such a one.
        """
        return Robot.of(self.description) if self.description else None

    @cached_property
    def joint_states(self) -> tuple[JointStates, ...]:
        """The joint states that the submission published."""
        return tuple(decoding.joint_states(m.tick, m.data) for m in self.on(JOINT_STATES))

    @cached_property
    def transforms(self) -> tuple[Transform, ...]:
        """All transforms on /tf and /tf_static, whoever sent them."""
        return tuple(
            transform
            for number, m in enumerate(self.messages)
            if m.topic in (TF, TF_STATIC)
            for transform in decoding.transforms(m.tick, m.data, number, m.topic, m.publisher)
        )

    def sha256(self) -> str:
        """A hash of every message; equal hashes mean equal runs."""
        digest = hashlib.sha256()
        for tick, topic, publisher, data in self.messages:
            digest.update(f"{tick} {topic} {publisher} {len(data)} ".encode())
            digest.update(data)
        return digest.hexdigest()


def check(trace: RobotTrace) -> None:
    """See whether a trace that comes from outside can be one.

    Raises:
        ValueError: something in it cannot have been recorded; the text says what.
    """
    before = 0
    for tick, topic, _, data in trace.messages:
        # what comes after the last tick would have taken effect in the next one
        if not before <= tick <= trace.ticks + 1:
            raise ValueError(f"{topic}: a message at tick {tick} of {trace.ticks}")
        before = tick
        decoding.check(TOPICS[topic], data)


def json_facts(trace: RobotTrace) -> str:
    """Who has published which message of each topic: 's' the submission, 'r' the scene."""
    letters = {"scene": "r", "submission": "s"}
    return json.dumps(
        {
            topic: "".join(letters[m.publisher] for m in trace.messages if m.topic == topic)
            for topic in TOPICS
        }
    )
