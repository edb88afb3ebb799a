"""A robot in its place: its shapes as triangles, where the links stand.

Sines are those of Python's math, which are the same on every processor.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from robot_py.kinematics import matrix
from robot_py.model import Box, Colour, Cylinder, Geometry, Mesh, Model, Sphere, Visual

Floats = npt.NDArray[np.float64]

#: Of a shape without a place, which stands at the origin, as in RViz.
WHITE: Colour = (1.0, 1.0, 1.0, 1.0)
#: Of a shape without a material, as in RViz.
RED: Colour = (1.0, 0.0, 0.0, 1.0)
#: Nothing is drawn beyond [m].
FARTHEST = 1e6
#: More shapes than this are drawn with fewer edges, many more not at all.
_EDGES = ((60, 32), (250, 16), (1500, 8))
_MOST_TRIANGLES = 100_000
#: The squares around all triangles may cover that around the robot so many times: each pixel of
#: them is computed.
_MOST_COVERED = 600


# Shapes -------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Triangles:
    """A surface.

    Attributes:
        corners: float64 (n, 3, 3): of each triangle three points x, y, z [m].
        normals: float64 (n, 3, 3): of each of these the direction of the surface.
    """

    corners: Floats
    normals: Floats

    def __len__(self) -> int:
        return len(self.corners)


NOTHING = Triangles(np.empty((0, 3, 3)), np.empty((0, 3, 3)))


def triangles(shape: Geometry, around: int = 32) -> Triangles:
    """Return a shape's surface; nothing for a mesh, whose file has not been read.

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
    """Return flat triangles: the normals of each are parallel.

    Triangles without an area are left out.
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
    normals = _strip(a, b, b, a)
    middle = np.zeros_like(a)
    top = np.stack((middle + half, a * radius + half, b * radius + half), axis=1)
    bottom = np.stack((middle - half, b * radius - half, a * radius - half), axis=1)
    caps = flat(np.concatenate((top, bottom)))
    return Triangles(
        np.concatenate((mantle, caps.corners)), np.concatenate((normals, caps.normals))
    )


def _sphere(radius: float, around: int) -> Triangles:
    ring, rows = _ring(around), max(around // 2, 3)
    tilts = [math.pi * k / rows - math.pi / 2 for k in range(rows + 1)]
    up = np.array((0.0, 0.0, 1.0))
    layers = [ring * math.cos(tilt) + up * math.sin(tilt) for tilt in tilts]
    normals = np.concatenate(
        [_strip(low[:-1], low[1:], high[1:], high[:-1]) for low, high in pairwise(layers)]
    )
    return Triangles(normals * radius, normals)


def _strip(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    """Return quadrilaterals as two triangles each."""
    return np.concatenate((np.stack((a, b, c), axis=1), np.stack((a, c, d), axis=1)))


# The whole robot ----------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Body:
    """Triangles in the world.

    Attributes:
        corners, normals: float64 (n, 3, 3), as in `Triangles`.
        colours: float64 (n, 4): red, green, blue, alpha from 0 to 1.
        links: int64 (n,): of which of `names`.
        names: of the robot's links.
        lost: those that have no place.
        left_out: meshes that have not been read, and shapes that are too many or too far to be
            drawn; each once, as the URDF names it.
    """

    corners: Floats
    normals: Floats
    colours: Floats
    links: npt.NDArray[np.int64]
    names: tuple[str, ...]
    lost: tuple[str, ...]
    left_out: tuple[str, ...]

    @property
    def lowest_m(self) -> float:
        """The height of its lowest point; 0 of nothing."""
        return float(self.corners[..., 2].min()) if len(self.corners) else 0.0


#: What there is to draw where there is no robot.
NOBODY = Body(
    NOTHING.corners,
    NOTHING.normals,
    np.empty((0, 4)),
    np.empty(0, dtype=np.int64),
    *((), (), ()),
)


def body(
    model: Model,
    frames: Mapping[str, Floats],
    meshes: Mapping[str, Floats] | None = None,
) -> Body:
    """Return the triangles of a robot whose links are in their places.

    Args:
        frames: of each link its transform into the world, 4 x 4. A link that is missing, or has
            a transform that is not finite, has no place.
        meshes: by the name that the URDF gives: triangles, float64 (n, 3, 3), not yet scaled.
    """
    names = tuple(model.links)
    placed = {name: frame for name, frame in frames.items() if is_place(frame)}
    visuals = list(_visuals(model))
    around = next((edges for most, edges in _EDGES if len(visuals) <= most), 0)
    left_out: dict[str, None] = {}
    parts: list[tuple[Triangles, Colour, int]] = []
    count, covered = 0, 0.0
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for number, visual in visuals:
        surface = _surface(visual, meshes or {}, around)
        place = placed.get(names[number])
        there = _moved(surface, (np.eye(4) if place is None else place), matrix(visual.origin))
        colour = WHITE if place is None else colour_of(visual)
        if not len(there) or count + len(there) > _MOST_TRIANGLES:
            left_out[_label(visual, names[number])] = None
            continue
        lowest, highest = there.corners.min(axis=1), there.corners.max(axis=1)
        covers = covered + float(np.square((highest - lowest).max(axis=1)).sum())
        below, above = np.minimum(low, lowest.min(axis=0)), np.maximum(high, highest.max(axis=0))
        if covers > _MOST_COVERED * float((above - below).max()) ** 2:
            left_out[_label(visual, names[number])] = None
        elif colour[3] > 0:
            parts.append((there, colour, number))
            count, covered, low, high = count + len(there), covers, below, above
    sizes = [len(surface) for surface, _, _ in parts]
    return Body(
        np.concatenate([NOTHING.corners, *(surface.corners for surface, _, _ in parts)]),
        np.concatenate([NOTHING.normals, *(surface.normals for surface, _, _ in parts)]),
        np.repeat(np.array([c for _, c, _ in parts]).reshape(-1, 4), sizes, axis=0),
        np.repeat(np.array([number for *_, number in parts], dtype=np.int64), sizes),
        names,
        tuple(name for name in names if name not in placed),
        tuple(left_out),
    )


def is_place(frame: Floats) -> bool:
    """Whether something can be drawn there."""
    return bool((np.abs(frame) < FARTHEST).all())


def colour_of(visual: Visual) -> Colour:
    """Return the colour that RViz shows; a texture's colour is not known."""
    if visual.material is None:
        return RED
    return WHITE if visual.material.texture else visual.material.rgba


def _visuals(model: Model) -> Iterator[tuple[int, Visual]]:
    """Yield every visual with the number of its link."""
    for number, link in enumerate(model.links.values()):
        for visual in link.visuals:
            yield number, visual


def _surface(visual: Visual, meshes: Mapping[str, Floats], around: int) -> Triangles:
    shape = visual.geometry
    if not around:
        return NOTHING
    if isinstance(shape, Mesh):
        corners = meshes.get(shape.filename)
        return NOTHING if corners is None else flat(corners * np.array(shape.scale))
    return triangles(shape, around)


def _label(visual: Visual, link: str) -> str:
    shape = visual.geometry
    return shape.filename if isinstance(shape, Mesh) else f"a shape of {link}"


def _moved(surface: Triangles, *frames: Floats) -> Triangles:
    """Move a surface through all frames, the last first; nothing where it ends too far away."""
    corners, normals = surface.corners, surface.normals
    with np.errstate(all="ignore"):
        for frame in reversed(frames):
            rotation = frame[:3, :3]
            corners = _turned(corners, rotation) + frame[:3, 3]
            normals = _turned(normals, rotation)
    if not (np.abs(corners) < FARTHEST).all() or not np.isfinite(normals).all():
        return NOTHING
    return Triangles(corners.round(7), normals.round(7))


def _turned(points: Floats, rotation: Floats) -> Floats:
    """Rotate term by term: a matrix product may add in another order on another processor."""
    x, y, z = points[..., 0], points[..., 1], points[..., 2]
    return np.stack([x * row[0] + y * row[1] + z * row[2] for row in rotation], axis=-1)
