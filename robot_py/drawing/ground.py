"""The ground below a robot: squares that fade, the robot's shadow, and the way that it went."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from robot_py.drawing.camera import Camera
from robot_py.drawing.raster import nearest
from robot_py.drawing.triangles import Floats

GROUND, LINES, SKY = (236.0, 239.0, 243.0), (150.0, 160.0, 172.0), (206.0, 216.0, 227.0)
SHADOW = 0.78
#: Where the light comes from.
LIGHT = np.array((0.35, 0.1, 0.93))


def ground(camera: Camera, height_m: float) -> Floats:
    """Sky and ground with its squares, float64 (size, size, 3).

    An edge is 1, 2 or 5 times a power of ten long; see `edge_m`.
    """
    rays = camera.rays()
    with np.errstate(all="ignore"):
        away = (height_m - camera.eye[2]) / rays[..., 2]
        there = (away > 0) & (away < 12 * camera.middle_m)
        away = np.where(there, away, 1.0)
        fade = np.clip(1 - away / (6 * camera.middle_m), 0, 1)
        shown = np.zeros_like(away)
        for axis in (0, 1):
            at = (camera.eye[axis] + away * rays[..., axis]) / edge_m(camera)
            steps = np.hypot(np.gradient(at, axis=0), np.gradient(at, axis=1))
            off = np.abs(at - np.round(at))
            shown = np.maximum(shown, np.clip(1.2 - off / np.maximum(steps, 1e-9), 0, 1))
        shown *= np.where(there, fade, 0)
    sky, floor, lines = (np.array(colour) for colour in (SKY, GROUND, LINES))
    base = sky + (floor - sky) * np.where(there, fade, 0)[..., np.newaxis]
    painted: Floats = base + (lines - base) * shown[..., np.newaxis]
    return painted


def edge_m(camera: Camera) -> float:
    """The edge of a square: about an eighth of what is seen."""
    raw = camera.middle_m / 10
    power = 10.0 ** math.floor(math.log10(raw))
    return float(power * next((m for m in (1, 2, 5) if m * power >= raw), 10))


def shadow(camera: Camera, corners: Floats, height_m: float) -> npt.NDArray[np.bool_]:
    """Where triangles above the ground throw their shadow, bool (size, size)."""
    above = corners[..., 2:] - height_m
    fallen = corners - LIGHT / LIGHT[2] * np.maximum(above, 0)
    pixels, ahead = camera.seen(fallen)
    in_front = (ahead > 0).all(axis=1)
    found, _ = nearest(pixels[in_front], ahead[in_front], camera.size_px)
    return found >= 0
