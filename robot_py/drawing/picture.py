"""Draws a robot: a camera that sees all of it, a z-buffer, light, edges and the ground."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw

from robot_py.drawing.body import Body, Floats

Pixels = npt.NDArray[np.uint8]
Ints = npt.NDArray[np.int64]

#: A pixel is the mean of so many squared.
_FINER = 2
_AMBIENT, _DIFFUSE, _FROM_EYE = 0.42, 0.5, 0.16
_EDGE = 0.55
_INK, _WAY = "#1c2330", "#1f6feb"
GROUND, LINES, SKY = (236.0, 239.0, 243.0), (150.0, 160.0, 172.0), (206.0, 216.0, 227.0)
SHADOW = 0.78
#: Where the light comes from.
LIGHT = np.array((0.35, 0.1, 0.93))
#: From the left in front of a robot, whose front is along x, and from above [rad].
AZIMUTH, ELEVATION = math.radians(40), math.radians(24)
#: Half of what is seen from edge to edge of the picture, as a tangent.
HALF_WIDTH = 0.32
#: What of the picture's half is used.
_FILLED = 0.86
#: How often the middle is moved to where it appears to be, and then measured again.
_STEPS = 6
#: A robot is never seen from nearer [m].
_NEAREST = 0.02
#: So many pixels are filled in one go.
_AT_ONCE = 400_000


def picture(
    robot: Body,
    size_px: int = 500,
    height_m: float = 0.0,
    ways: Sequence[Floats] = (),
    labels: Sequence[str] = (),
) -> Pixels:
    """Draw a robot, uint8 (size, size, 3).

    Args:
        height_m: of the ground.
        ways: lines on the ground, float64 (n, 2) each; all of them are in the picture.
        labels: lines of text in the picture's upper left corner.
    """
    lines = [np.column_stack((way, np.full(len(way), height_m))) for way in ways]
    everything = np.concatenate([robot.corners.reshape(-1, 3), *lines])
    if not len(everything):
        everything = np.array(((-1.0, -1.0, height_m), (1.0, 1.0, height_m)))
    camera = Camera.at(everything, size_px * _FINER)
    painted = ground(camera, height_m)
    painted[shadow(camera, robot.corners, height_m)] *= SHADOW
    painted = _with_lines(painted, [camera.seen(line)[0] for line in lines])
    is_glass = robot.colours[:, 3] < 0.99
    for through in (False, True):
        chosen = np.flatnonzero(is_glass == through)
        if len(chosen):
            _paint(painted, robot, chosen, camera, None if not through else ~is_glass)
    coarse = painted.reshape(size_px, _FINER, size_px, _FINER, 3).mean(axis=(1, 3))
    finished = np.clip(np.floor(coarse + 0.5), 0, 255).astype(np.uint8)
    return _labelled(finished, labels)


def _paint(
    painted: Floats,
    robot: Body,
    chosen: Ints,
    camera: Camera,
    before: npt.NDArray[np.bool_] | None,
) -> None:
    """Paint some triangles over the others.

    Args:
        before: the triangles that hide these; None for none.
    """
    pixels, ahead = camera.seen(robot.corners[chosen])
    found, nearness = nearest(pixels, ahead, camera.size_px)
    if before is not None and before.any():
        _, hides = nearest(*camera.seen(robot.corners[before]), camera.size_px)
        found[hides >= nearness] = -1
    rows, columns = np.nonzero(found >= 0)
    number = found[rows, columns]
    shares = barycentric(pixels[number], columns, rows)
    normals = (robot.normals[chosen[number]] * shares[..., np.newaxis]).sum(axis=1)
    light = _light(normals, camera)
    colours = robot.colours[chosen[number]]
    alpha = colours[:, 3:]
    shaded = np.minimum(colours[:, :3] * light[:, np.newaxis], 1) * 255
    shaded *= _edges(found, robot.links[chosen])[rows, columns][:, np.newaxis]
    painted[rows, columns] = shaded * alpha + painted[rows, columns] * (1 - alpha)


def _light(normals: Floats, camera: Camera) -> Floats:
    length = np.sqrt((normals * normals).sum(axis=1))
    normals = normals / np.maximum(length, 1e-9)[:, np.newaxis]
    towards = -(normals * camera.ahead).sum(axis=1)
    # an open surface is seen from behind as well
    normals = np.where((towards < 0)[:, np.newaxis], -normals, normals)
    from_sun = np.maximum((normals * (LIGHT / np.sqrt((LIGHT * LIGHT).sum()))).sum(axis=1), 0)
    light: Floats = _AMBIENT + _DIFFUSE * from_sun + _FROM_EYE * np.abs(towards)
    return light


def _edges(found: Ints, links: Ints) -> Floats:
    """Return the brightness of pixels: darker where a link ends."""
    link = np.where(found >= 0, links[np.maximum(found, 0)], -1)
    edge = np.zeros(link.shape, dtype=bool)
    edge[:, 1:] |= link[:, 1:] != link[:, :-1]
    edge[1:] |= link[1:] != link[:-1]
    return np.where(edge, _EDGE, 1.0)


def _with_lines(painted: Floats, lines: Sequence[Floats]) -> Floats:
    if not lines:
        return painted
    image = Image.fromarray(np.clip(painted, 0, 255).astype(np.uint8))
    draw = ImageDraw.Draw(image)
    for line in lines:
        if len(line) > 1:
            draw.line([tuple(point) for point in line.tolist()], _WAY, 2 * _FINER, joint="curve")
    return np.asarray(image).astype(np.float64)


def _labelled(pixels: Pixels, labels: Sequence[str]) -> Pixels:
    if not labels:
        return pixels
    image = Image.fromarray(pixels)
    draw = ImageDraw.Draw(image)
    for row, words in enumerate(labels):
        text = words.encode("ascii", "replace").decode()
        place = (10, 10 + 16 * row)
        draw.rectangle(draw.textbbox(place, text), "#ffffff")
        draw.text(place, text, _INK)
    return np.asarray(image)


# The ground ---------------------------------------------------------------------------------------


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
    """Return the edge of a square [m]: about an eighth of the picture."""
    raw = camera.middle_m / 10
    power = 10.0 ** math.floor(math.log10(raw))
    return float(power * next((m for m in (1, 2, 5) if m * power >= raw), 10))


def shadow(camera: Camera, corners: Floats, height_m: float) -> npt.NDArray[np.bool_]:
    """Return where triangles above the ground throw their shadow, bool (size, size)."""
    above = corners[..., 2:] - height_m
    fallen = corners - LIGHT / LIGHT[2] * np.maximum(above, 0)
    pixels, ahead = camera.seen(fallen)
    in_front = (ahead > 0).all(axis=1)
    found, _ = nearest(pixels[in_front], ahead[in_front], camera.size_px)
    return found >= 0


# Camera and z-buffer ------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Camera:
    """An eye with a direction; the picture is square.

    Attributes:
        eye: where it stands [m].
        right, up, ahead: unit vectors.
        middle_m: the distance of the middle of the picture.
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
        """Return a camera that sees all points, float64 (n, 3), at least one."""
        sin, cos = math.sin(AZIMUTH), math.cos(AZIMUTH)
        flat, high = math.cos(ELEVATION), math.sin(ELEVATION)
        ahead = np.array((-cos * flat, -sin * flat, -high))
        right = np.array((-sin, cos, 0.0))
        up = np.array((-cos * high, -sin * high, flat))
        seen = np.stack([_along(points, axis) for axis in (right, up, ahead)], axis=-1)
        middle = (seen.min(axis=0) + seen.max(axis=0)) / 2
        away = _NEAREST
        for _ in range(_STEPS):
            offsets = seen - middle
            wide = np.abs(offsets[:, :2]).max(axis=1) / (HALF_WIDTH * _FILLED)
            needed = np.maximum(wide - offsets[:, 2], -1.25 * offsets[:, 2])
            away = max(_NEAREST, float(needed.max()))
            # near things appear larger: so the middle of the picture is not that of the things
            flat_ = offsets[:, :2] / (away + offsets[:, 2:])
            middle[:2] += (flat_.min(axis=0) + flat_.max(axis=0)) / 2 * away
        away = round(away, 6)
        eye = right * middle[0] + up * middle[1] + ahead * (middle[2] - away)
        return cls(eye.round(7), right, up, ahead, away, size_px)

    @property
    def focal_px(self) -> float:
        """The width [px] of a metre, a metre away."""
        return self.size_px / 2 / HALF_WIDTH

    def seen(self, points: Floats) -> tuple[Floats, Floats]:
        """Return points (..., 3) as pixels (..., 2), y down, and their distances (...,) [m]."""
        offsets = points - self.eye
        ahead = _along(offsets, self.ahead)
        with np.errstate(all="ignore"):
            scale = self.focal_px / ahead
            x = self.size_px / 2 + _along(offsets, self.right) * scale
            y = self.size_px / 2 - _along(offsets, self.up) * scale
        # to a fraction of a pixel: no rounding of another processor's decides what is inside
        return np.stack((x, y), axis=-1).round(4), ahead

    def rays(self) -> Floats:
        """Return the direction of each pixel, one metre ahead: float64 (size, size, 3)."""
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


def nearest(pixels: Floats, ahead: Floats, size_px: int) -> tuple[Ints, Floats]:
    """Return for each pixel the number of the triangle that is seen there, -1 for none.

    Args:
        pixels: the corners in the picture, float64 (n, 3, 2).
        ahead: how far away these are, all above 0, float64 (n, 3).

    Returns:
        int64 (size, size), and the inverse of how far away that is, 0 for nothing.
    """
    inverse = 1 / ahead
    nearness = np.zeros(size_px * size_px)
    found = np.full(size_px * size_px, -1, dtype=np.int64)
    for number, x, y in _candidates(pixels, size_px):
        shares = barycentric(pixels[number], x, y)
        inside = (shares >= 0).all(axis=1)
        number, place = number[inside], (y * size_px + x)[inside]
        # over a plane in space, the inverse of the distance is linear in the picture
        near = (shares[inside] * inverse[number]).sum(axis=1)
        np.maximum.at(nearness, place, near)
        wins = near == nearness[place]
        found[place[wins]] = number[wins]
    return found.reshape(size_px, size_px), nearness.reshape(size_px, size_px)


def barycentric(corners: Floats, column: Ints, row: Ints) -> Floats:
    """Return the weight of each corner at a pixel's middle: float64 (n, 3), all >= 0 inside."""
    x, y = column.astype(np.float64) + 0.5, row.astype(np.float64) + 0.5
    (ax, ay), (bx, by), (cx, cy) = (corners[:, k].T for k in range(3))
    area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
    with np.errstate(all="ignore"):
        b = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area
        c = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area
        shares = np.stack((1 - b - c, b, c), axis=1)
    shares[area == 0] = -1
    return shares


def _candidates(pixels: Floats, size_px: int) -> Iterator[tuple[Ints, Ints, Ints]]:
    """Yield triangles with the pixels of the boxes around them: number, x, y."""
    low = np.clip(np.floor(pixels.min(axis=1)), 0, size_px).astype(np.int64)
    high = np.clip(np.ceil(pixels.max(axis=1)), 0, size_px).astype(np.int64)
    wide, tall = (high - low).T
    counts = wide * tall
    begin = 0
    ends = np.cumsum(counts)
    while begin < len(counts):
        before = ends[begin - 1] if begin else 0
        end = max(int(np.searchsorted(ends, before + _AT_ONCE, side="right")), begin + 1)
        each = counts[begin:end]
        number = np.repeat(np.arange(begin, end), each)
        within = np.arange(len(number)) - np.repeat(ends[begin:end] - each - before, each)
        down, along = np.divmod(within, np.maximum(wide[number], 1))
        yield number, low[number, 0] + along, low[number, 1] + down
        begin = end
