"""Transforms for tests: as messages, and as the 4x4 matrices that they stand for."""

from collections.abc import Sequence

import numpy as np
from geometry_msgs.msg import TransformStamped
from rclpy.time import Time

UNTURNED = (0.0, 0.0, 0.0, 1.0)


def transform(
    parent: str,
    child: str,
    at_s: float = 0.0,
    xyz: Sequence[float] = (0.0, 0.0, 0.0),
    turned: Sequence[float] = UNTURNED,
) -> TransformStamped:
    """`child` in `parent`, at a time; `turned` is a quaternion, w last."""
    message = TransformStamped()
    message.header.frame_id, message.child_frame_id = parent, child
    message.header.stamp = at(at_s).to_msg()
    t, q = message.transform.translation, message.transform.rotation
    t.x, t.y, t.z = map(float, xyz)
    q.x, q.y, q.z, q.w = map(float, turned)
    return message


def at(time_s: float) -> Time:
    return Time(nanoseconds=round(time_s * 1e9))


def xyz(message: TransformStamped) -> list[float]:
    t = message.transform.translation
    return [t.x, t.y, t.z]


def quaternion(message: TransformStamped) -> list[float]:
    q = message.transform.rotation
    return [q.x, q.y, q.z, q.w]


def stamp_s(message: TransformStamped) -> float:
    return Time.from_msg(message.header.stamp).nanoseconds / 1e9


def matrix(message: TransformStamped) -> np.ndarray:
    """Homogeneous, 4x4; by the textbook's formula for a quaternion of any length."""
    x, y, z, w = quaternion(message)
    v = np.array([x, y, z])
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    rotation = (w * w - v @ v) * np.eye(3) + 2 * np.outer(v, v) + 2 * w * cross
    whole = np.eye(4)
    whole[:3, :3] = rotation / (w * w + v @ v)
    whole[:3, 3] = xyz(message)
    return whole
