"""Where the links of a robot are, as robot_state_publisher computes it: pure functions.

The formulas and their order are those of kdl_parser and KDL: a joint without a usable axis yields
NaN, as there, and so does a position that is NaN. A transform is an array of 4 x 4 numbers that
maps a point's coordinates in the child's frame to those in the parent's.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter

import numpy as np
from numpy.typing import NDArray

from grader_robots.robot_py.model import Joint, JointType, Model, Origin, Vector

Transform = NDArray[np.float64]

#: Below this trace KDL computes a quaternion of a matrix in another way.
SMALLEST_TRACE = 1e-12


@dataclass(frozen=True, slots=True)
class LinkTree:
    """How the links hang on each other, as kdl_parser finds it.

    Attributes:
        joints: of each link but the root the joint that holds it, parents before children. A link
            that several joints claim hangs on the last of them by the alphabet.
        is_endless: links that the root holds go round in a circle. kdl_parser does not survive
            that: robot_state_publisher ends with a stack overflow.
    """

    joints: Mapping[str, Joint]
    is_endless: bool

    @property
    def moving(self) -> dict[str, Joint]:
        """The joints that a joint state moves, by name, by the alphabet."""
        return self._sorted(joint for joint in self.joints.values() if joint.type.is_movable)

    @property
    def fixed(self) -> dict[str, Joint]:
        """The joints that are sent once, by name, by the alphabet; planar ones count as fixed."""
        fixed = (JointType.FIXED, JointType.PLANAR)
        return self._sorted(joint for joint in self.joints.values() if joint.type in fixed)

    @staticmethod
    def _sorted(joints: Iterator[Joint]) -> dict[str, Joint]:
        return {joint.name: joint for joint in sorted(joints, key=lambda joint: joint.name)}


def tree(model: Model) -> LinkTree:
    """Return how a robot's links hang on each other."""
    holder: dict[str, Joint] = {}
    children: dict[str, list[str]] = {}
    for name in sorted(model.joints):
        joint = model.joints[name]
        holder[joint.child] = joint
        children.setdefault(joint.parent, []).append(joint.child)
    return LinkTree(_hanging(model.root, holder), _is_endless(model.root, children))


def _hanging(root: str, holder: Mapping[str, Joint]) -> dict[str, Joint]:
    """Return the joints of all links that are held by the root, parents before children."""
    held: dict[str, list[Joint]] = {}
    for joint in holder.values():
        held.setdefault(joint.parent, []).append(joint)
    hanging: dict[str, Joint] = {}
    waiting = [root]
    while waiting:
        for joint in held.get(waiting.pop(), []):
            hanging[joint.child] = joint
            waiting.append(joint.child)
    return hanging


def _is_endless(root: str, children: Mapping[str, list[str]]) -> bool:
    """Whether a link below the root is also above itself."""
    below: dict[str, list[str]] = {}
    waiting = [root]
    while waiting:
        link = waiting.pop()
        if link not in below:
            below[link] = children.get(link, [])
            waiting.extend(below[link])
    try:
        TopologicalSorter(below).prepare()
    except CycleError:
        return True
    return False


def matrix(origin: Origin) -> Transform:
    """Return an origin as a transform."""
    return _transform(_rotation_rpy(*origin.rpy), origin.xyz)


def joint_transform(joint: Joint, position: float = 0.0) -> Transform:
    """Return the transform from the child's frame to the parent's.

    Args:
        position: how far the joint is turned [rad] or pushed out [m]; fixed, planar and floating
            ones do not heed it.
    """
    origin = matrix(joint.origin)
    if not joint.type.is_movable:
        return origin
    with np.errstate(invalid="ignore", divide="ignore"):
        along = origin[:3, :3] @ np.array(joint.axis)
        axis = along / np.sqrt(along @ along)
        if joint.type is JointType.PRISMATIC:
            origin[:3, 3] += axis * position
            return origin
        turn = _rotation_about(axis, position)
        turned = _transform(turn @ origin[:3, :3], origin[:3, 3])
        turned[:3, 3] += turn @ np.zeros(3)  # NaN where the turn is, as in KDL
        return turned


def forward(model: Model, positions: Mapping[str, float]) -> dict[str, Transform]:
    """Return every link's frame in the root's, parents before children.

    Args:
        positions: of joints by name [rad or m]. A joint that is not named is at 0. Mimics are not
            filled in: `with_mimics` does that.

    A link that nothing connects with the root is not among them. A floating joint is at its origin.
    """
    frames = {model.root: np.eye(4)}
    for link, joint in tree(model).joints.items():
        position = positions.get(joint.name, 0.0)
        frames[link] = frames[joint.parent] @ joint_transform(joint, position)
    return frames


def with_mimics(model: Model, positions: Mapping[str, float]) -> dict[str, float]:
    """Return the positions with those of mimicking joints, as robot_state_publisher finds them.

    A position that is given is left alone. One pass by the alphabet: the follower of a follower
    gets one only where the follower stands first.
    """
    found = dict(positions)
    for name in sorted(model.joints):
        mimic = model.joints[name].mimic
        if mimic is not None and mimic.joint in found:
            found.setdefault(name, found[mimic.joint] * mimic.multiplier + mimic.offset)
    return found


def translation(transform: Transform) -> Vector:
    """Return where the child's frame is [m]."""
    x, y, z = (float(value) for value in transform[:3, 3])
    return x, y, z


def quaternion(transform: Transform) -> tuple[float, float, float, float]:
    """Return the turn of the child's frame: x, y, z, w, as KDL's Rotation::GetQuaternion does."""
    m = [[float(value) for value in row] for row in transform[:3, :3]]
    trace = m[0][0] + m[1][1] + m[2][2]
    if trace > SMALLEST_TRACE:
        s = 0.5 / math.sqrt(trace + 1.0)
        x, y, z = (m[2][1] - m[1][2]) * s, (m[0][2] - m[2][0]) * s, (m[1][0] - m[0][1]) * s
        return x, y, z, 0.25 / s
    if math.isnan(trace):
        return math.nan, math.nan, math.nan, math.nan
    if m[0][0] > m[1][1] and m[0][0] > m[2][2]:
        s = 2.0 * math.sqrt(1.0 + m[0][0] - m[1][1] - m[2][2])
        y, z = (m[0][1] + m[1][0]) / s, (m[0][2] + m[2][0]) / s
        return 0.25 * s, y, z, (m[2][1] - m[1][2]) / s
    if m[1][1] > m[2][2]:
        s = 2.0 * math.sqrt(1.0 + m[1][1] - m[0][0] - m[2][2])
        x, z = (m[0][1] + m[1][0]) / s, (m[1][2] + m[2][1]) / s
        return x, 0.25 * s, z, (m[0][2] - m[2][0]) / s
    s = 2.0 * math.sqrt(1.0 + m[2][2] - m[0][0] - m[1][1])
    x, y = (m[0][2] + m[2][0]) / s, (m[1][2] + m[2][1]) / s
    return x, y, 0.25 * s, (m[1][0] - m[0][1]) / s


def _transform(rotation: NDArray[np.float64], offset: Vector | NDArray[np.float64]) -> Transform:
    transform = np.eye(4)
    transform[:3, :3] = rotation
    transform[:3, 3] = offset
    return transform


def _rotation_rpy(roll: float, pitch: float, yaw: float) -> NDArray[np.float64]:
    """Rz(yaw) · Ry(pitch) · Rx(roll), over the quaternion that urdfdom makes of it."""
    sr, cr = math.sin(roll / 2), math.cos(roll / 2)
    sp, cp = math.sin(pitch / 2), math.cos(pitch / 2)
    sy, cy = math.sin(yaw / 2), math.cos(yaw / 2)
    q = np.array(
        (
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
            cr * cp * cy + sr * sp * sy,
        )
    )
    x, y, z, w = q / math.sqrt(q @ q)
    xx, yy, zz, ww = x * x, y * y, z * z, w * w
    return np.array(
        (
            (ww + xx - yy - zz, 2 * x * y - 2 * w * z, 2 * x * z + 2 * w * y),
            (2 * x * y + 2 * w * z, ww - xx + yy - zz, 2 * y * z - 2 * w * x),
            (2 * x * z - 2 * w * y, 2 * y * z + 2 * w * x, ww - xx - yy + zz),
        )
    )


def _rotation_about(axis: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Return a turn [rad] about an axis of length 1, as KDL's Rotation::Rot2."""
    c, s = (math.cos(angle), math.sin(angle)) if math.isfinite(angle) else (math.nan, math.nan)
    x, y, z = axis
    v = 1 - c
    return np.array(
        (
            (c + v * x * x, v * x * y - s * z, v * x * z + s * y),
            (v * x * y + s * z, c + v * y * y, v * y * z - s * x),
            (v * x * z - s * y, v * y * z + s * x, c + v * z * z),
        )
    )
