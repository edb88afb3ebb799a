"""Messages out of their bytes, as plain data; their definitions, and nothing of ROS."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

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


class JointStates(NamedTuple):
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
        """Whether robot_state_publisher takes it."""
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


def text(data: bytes) -> str:
    """The text of a std_msgs/String."""
    return str(_read(STRING, data).data)


def joint_states(tick: int, data: bytes) -> JointStates:
    """A sensor_msgs/JointState."""
    read = _read(JOINT_STATE, data)
    positions = tuple(read.position.tolist())
    return JointStates(tick, _ns(read.header.stamp), tuple(read.name), positions)


def transforms(tick: int, data: bytes, number: int, topic: str, publisher: str) -> list[Transform]:
    """Those of a tf2_msgs/TFMessage."""
    return [
        Transform(
            *(tick, number, topic, publisher, _ns(each.header.stamp)),
            *(each.header.frame_id, each.child_frame_id),
            (moved.x, moved.y, moved.z),
            (turned.x, turned.y, turned.z, turned.w),
        )
        for each in _read(TF_MESSAGE, data).transforms
        for moved, turned in [(each.transform.translation, each.transform.rotation)]
    ]


def look(msgtype: str, data: bytes) -> None:
    """See whether bytes are a message.

    Raises:
        Exception: they are none; rosbags' own, or anything that its reader raises.
    """
    _read(msgtype, data)


def _read(msgtype: str, data: bytes) -> Any:
    # here: a run in which nothing is judged needs no rosbags
    from grader.scenes.message_types import types_of

    return types_of(DEFINITIONS).deserialize_cdr(data, msgtype)


def _ns(stamp: Any) -> int:
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)
