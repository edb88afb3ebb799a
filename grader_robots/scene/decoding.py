"""Messages out of their bytes, as plain data; their definitions, and nothing of ROS."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

from grader.rosidl.cdr import CdrReader, string_of

JOINT_STATE, TF_MESSAGE = "sensor_msgs/msg/JointState", "tf2_msgs/msg/TFMessage"
STRING = "std_msgs/msg/String"
#: Where ROS is not sourced there may be no share/ to ask. ROS's own, of Jazzy.
DEFINITIONS = {
    STRING: "string data\n",
    "std_msgs/msg/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
    JOINT_STATE: "std_msgs/Header header\nstring[] name\nfloat64[] position\n"
    "float64[] velocity\nfloat64[] effort\n",
    "geometry_msgs/msg/Vector3": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/msg/Quaternion": "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n",
    "geometry_msgs/msg/Transform": "Vector3 translation\nQuaternion rotation\n",
    "geometry_msgs/msg/TransformStamped": "std_msgs/Header header\nstring child_frame_id\n"
    "Transform transform\n",
    TF_MESSAGE: "geometry_msgs/TransformStamped[] transforms\n",
}


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
    read = CdrReader(data)
    stamp_ns, _ = read.stamp_ns(), read.text()
    names, positions = read.texts(), read.numbers()
    read.numbers(), read.numbers()  # velocities and efforts
    read.end()
    return HeardJointState(tick, stamp_ns, names, positions)


def transforms(tick: int, data: bytes, number: int, topic: str, publisher: str) -> list[Transform]:
    """Those of a tf2_msgs/TFMessage."""
    read = CdrReader(data)
    found = []
    for _ in range(read.number("I")):
        stamp_ns, parent, child = read.stamp_ns(), read.text(), read.text()
        x, y, z, *rotation = read.array(7).tolist()
        a, b, c, d = rotation
        placed = (parent, child, (x, y, z), (a, b, c, d))
        found.append(Transform(tick, number, topic, publisher, stamp_ns, *placed))
    read.end()
    return found


#: By the type of a message: reads its bytes, or raises ValueError.
READERS: dict[str, Callable[[bytes], Any]] = {
    STRING: string_of,
    JOINT_STATE: lambda data: joint_states(0, data),
    TF_MESSAGE: lambda data: transforms(0, data, 0, "", ""),
}
