"""Shapes as triangles; sines are Python's own, which are the same on every processor."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from robot_py.model import Box, Cylinder, Geometry, Sphere

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Triangles:
    """A surface.

    Attributes:
        corners: float64 (n, 3, 3): of each triangle three points x, y, z [m].
        normals: float64 (n, 3, 3): of each of these the direction in which the surface looks.
    """

    corners: Floats
    normals: Floats

    def __len__(self) -> int:
        return len(self.corners)


NOTHING = Triangles(np.empty((0, 3, 3)), np.empty((0, 3, 3)))


def triangles(shape: Geometry, around: int = 32) -> Triangles:
    """A shape's surface; nothing for a mesh, whose file nobody has read.

    Args:
        around: edges of what is round.
    """
    if isinstance(shape, Box):
        return _box(*shape.size)
    if isinstance(shape, Cylinder):
        return _cylinder(shape.radius, shape.length, around)
    if isinstance(shape, Sphere):
        return _sphere(shape.radius, around)
    return NOTHING


def flat(corners: Floats) -> Triangles:
    """Triangles that are not round: each looks in one direction.

    Those without an area are left out.
    """
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    across = np.cross(b - a, c - a)
    length = np.sqrt((across * across).sum(axis=1))
    there = length > 0
    normals = across[there] / length[there, np.newaxis]
    return Triangles(corners[there], np.repeat(normals[:, np.newaxis], 3, axis=1))


def _box(x: float, y: float, z: float) -> Triangles:
    signs = np.array([(i, j, k) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    points = signs * np.array((x, y, z)) / 2
    # each side counter-clockwise, seen from outside
    sides = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    return flat(np.array([points[[s[0], s[i], s[i + 1]]] for s in sides for i in (1, 2)]))


def _ring(around: int) -> Floats:
    turns = [2 * math.pi * k / around for k in range(around + 1)]
    ring = np.array([(math.cos(turn), math.sin(turn), 0.0) for turn in turns])
    ring[-1] = ring[0]
    return ring


def _cylinder(radius: float, length: float, around: int) -> Triangles:
    ring, half = _ring(around), np.array((0.0, 0.0, length / 2))
    a, b = ring[:-1], ring[1:]
    mantle = _strip(a * radius - half, b * radius - half, b * radius + half, a * radius + half)
    looks = _strip(a, b, b, a)
    middle = np.zeros_like(a)
    top = np.stack((middle + half, a * radius + half, b * radius + half), axis=1)
    bottom = np.stack((middle - half, b * radius - half, a * radius - half), axis=1)
    caps = flat(np.concatenate((top, bottom)))
    return Triangles(np.concatenate((mantle, caps.corners)), np.concatenate((looks, caps.normals)))


def _sphere(radius: float, around: int) -> Triangles:
    ring, rows = _ring(around), max(around // 2, 3)
    tilts = [math.pi * k / rows - math.pi / 2 for k in range(rows + 1)]
    up = np.array((0.0, 0.0, 1.0))
    layers = [ring * math.cos(tilt) + up * math.sin(tilt) for tilt in tilts]
    looks = np.concatenate(
        [_strip(low[:-1], low[1:], high[1:], high[:-1]) for low, high in pairwise(layers)]
    )
    return Triangles(looks * radius, looks)


def _strip(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    """Quadrilaterals as two triangles each."""
    return np.concatenate((np.stack((a, b, c), axis=1), np.stack((a, c, d), axis=1)))
