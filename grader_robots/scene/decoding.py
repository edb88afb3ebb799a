"""Messages out of their bytes, as plain data; nothing of ROS is needed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final, NamedTuple

from grader.recording import BagTypes

JOINT_STATE, TF_MESSAGE = "sensor_msgs/msg/JointState", "tf2_msgs/msg/TFMessage"
STRING = "std_msgs/msg/String"
TYPES: Final = BagTypes({})


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


def joint_states(tick: int, data: bytes) -> HeardJointState:
    """A sensor_msgs/JointState."""
    found = TYPES.values(data, JOINT_STATE)
    names, positions = tuple(found["name"]), tuple(found["position"])
    return HeardJointState(tick, _stamp_ns(found), names, positions)


def transforms(tick: int, data: bytes, number: int, topic: str, publisher: str) -> list[Transform]:
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
