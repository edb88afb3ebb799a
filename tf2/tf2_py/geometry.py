"""Rotations as unit quaternions (x, y, z, w), and poses: a rotation, then a translation [m].

A pose of a child frame in its parent maps the coordinates of a point in the child to those in the
parent.
"""

from __future__ import annotations

import math
import sys
from typing import NamedTuple

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]


class FramePose(NamedTuple):
    """Where a frame is in another."""

    rotation: Quaternion
    translation: Vector


IDENTITY = FramePose((0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0))


def unit(q: Quaternion) -> Quaternion:
    """Return the same rotation in the form that tf2 gives: of length 1, one of q and −q.

    tf2 goes by way of the rotation matrix. So w is positive where it is more than ½ in size, else
    the largest of x, y and z is. A quaternion without a length gives −NaN, as it does there.
    """
    squared = sum(part * part for part in q)
    if squared < sys.float_info.min:
        return (-math.nan, -math.nan, -math.nan, -math.nan)
    length = math.sqrt(squared)
    x, y, z, w = (part / length for part in q)
    leading = w if abs(w) > 0.5 else max((x, y, z), key=abs)
    return (-x, -y, -z, -w) if leading < 0.0 else (x, y, z, w)


def multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    """Rotate by b, then by a."""
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def rotate(q: Quaternion, v: Vector) -> Vector:
    """Rotate a vector by a unit quaternion: v + 2w (u × v) + 2 u × (u × v)."""
    ux, uy, uz, w = q
    vx, vy, vz = v
    tx, ty, tz = 2 * (uy * vz - uz * vy), 2 * (uz * vx - ux * vz), 2 * (ux * vy - uy * vx)
    return (
        vx + w * tx + uy * tz - uz * ty,
        vy + w * ty + uz * tx - ux * tz,
        vz + w * tz + ux * ty - uy * tx,
    )


def compose(outer: FramePose, inner: FramePose) -> FramePose:
    """Return the pose of c in a from those of b in a and of c in b."""
    x, y, z = rotate(outer.rotation, inner.translation)
    dx, dy, dz = outer.translation
    return FramePose(multiply(outer.rotation, inner.rotation), (x + dx, y + dy, z + dz))


def inverse(pose: FramePose) -> FramePose:
    """Return the pose of a in b from that of b in a."""
    x, y, z, w = pose.rotation
    back = (-x, -y, -z, w)
    dx, dy, dz = pose.translation
    return FramePose(back, rotate(back, (-dx, -dy, -dz)))


def interpolate(a: FramePose, b: FramePose, ratio: float) -> FramePose:
    """Return what is between a (ratio 0) and b (1): translations on a line, rotations slerped."""
    ax, ay, az = a.translation
    bx, by, bz = b.translation
    rest = 1.0 - ratio
    between = (rest * ax + ratio * bx, rest * ay + ratio * by, rest * az + ratio * bz)
    return FramePose(slerp(a.rotation, b.rotation, ratio), between)


def slerp(a: Quaternion, b: Quaternion, ratio: float) -> Quaternion:
    """Turn from a to b on the shorter way with constant speed."""
    cosine = sum(p * q for p, q in zip(a, b, strict=True))
    angle = math.acos(min(abs(cosine), 1.0))
    if angle == 0.0:
        return a
    from_a = math.sin((1.0 - ratio) * angle) / math.sin(angle)
    from_b = math.copysign(math.sin(ratio * angle) / math.sin(angle), cosine)
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (
        from_a * ax + from_b * bx,
        from_a * ay + from_b * by,
        from_a * az + from_b * bz,
        from_a * aw + from_b * bw,
    )
