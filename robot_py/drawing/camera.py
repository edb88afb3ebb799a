"""Where a picture is taken from, so that all that matters is in it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Self

import numpy as np

from robot_py.drawing.triangles import Floats

#: From the left in front of a robot, which looks along x, and from above [rad].
AZIMUTH, ELEVATION = math.radians(40), math.radians(24)
#: Half of what is seen from edge to edge of the picture, as a tangent.
HALF_WIDTH = 0.32
#: What of the picture's half is used.
_FILLED = 0.86
#: So often the middle is moved to where it looks like the middle, and once more looked at.
_STEPS = 6
#: A robot is never seen from nearer [m].
_NEAREST = 0.02


@dataclass(frozen=True, eq=False)
class Camera:
    """An eye with a direction; the picture is square.

    Attributes:
        eye: where it stands [m].
        right, up, ahead: unit vectors.
        middle_m: how far away is what it looks at.
        size_px: the picture's edge.
    """

    eye: Floats
    right: Floats
    up: Floats
    ahead: Floats
    middle_m: float
    size_px: int

    @classmethod
    def at(cls, points: Floats, size_px: int) -> Self:
        """One that sees all points, float64 (n, 3)."""
        sin, cos = math.sin(AZIMUTH), math.cos(AZIMUTH)
        flat, high = math.cos(ELEVATION), math.sin(ELEVATION)
        ahead = np.array((-cos * flat, -sin * flat, -high))
        right = np.array((-sin, cos, 0.0))
        up = np.array((-cos * high, -sin * high, flat))
        seen = np.stack([_along(points, axis) for axis in (right, up, ahead)], axis=-1)
        low, high_ = (seen.min(axis=0), seen.max(axis=0)) if len(seen) else (np.zeros(3),) * 2
        middle = (low + high_) / 2
        away = _NEAREST
        for _ in range(_STEPS):
            offsets = seen - middle
            wide = np.abs(offsets[:, :2]).max(axis=1) / (HALF_WIDTH * _FILLED)
            needed = np.maximum(wide - offsets[:, 2], -1.25 * offsets[:, 2])
            away = max(_NEAREST, float(needed.max(initial=0.0)))
            # what is near looks larger: so the middle of the picture is not that of the things
            flat_ = offsets[:, :2] / (away + offsets[:, 2:])
            if len(flat_):
                middle[:2] += (flat_.min(axis=0) + flat_.max(axis=0)) / 2 * away
        away = round(away, 6)
        eye = right * middle[0] + up * middle[1] + ahead * (middle[2] - away)
        return cls(eye.round(7), right, up, ahead, away, size_px)

    @property
    def focal_px(self) -> float:
        """Pixels of what is a metre wide, a metre away."""
        return self.size_px / 2 / HALF_WIDTH

    def seen(self, points: Floats) -> tuple[Floats, Floats]:
        """Points (..., 3) as pixels (..., 2), y down, and how far ahead they are (...,) [m]."""
        offsets = points - self.eye
        ahead = _along(offsets, self.ahead)
        with np.errstate(all="ignore"):
            scale = self.focal_px / ahead
            x = self.size_px / 2 + _along(offsets, self.right) * scale
            y = self.size_px / 2 - _along(offsets, self.up) * scale
        # to a fraction of a pixel: no rounding of another processor's decides what is inside
        return np.stack((x, y), axis=-1).round(4), ahead

    def rays(self) -> Floats:
        """Of each pixel the direction, as far as one metre ahead: float64 (size, size, 3)."""
        steps = (np.arange(self.size_px) + 0.5 - self.size_px / 2) / self.focal_px
        rays: Floats = (
            self.ahead
            + self.right * steps[np.newaxis, :, np.newaxis]
            - self.up * steps[:, np.newaxis, np.newaxis]
        )
        return rays


def _along(points: Floats, axis: Floats) -> Floats:
    x, y, z = points[..., 0], points[..., 1], points[..., 2]
    along: Floats = x * axis[0] + y * axis[1] + z * axis[2]
    return along
