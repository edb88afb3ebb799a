"""A robot drawn: z-buffer, light, edges, ground, and the names of what has no place."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw

from robot_py.drawing.body import Body
from robot_py.drawing.camera import Camera
from robot_py.drawing.ground import LIGHT, SHADOW, ground, shadow
from robot_py.drawing.raster import barycentric, nearest
from robot_py.drawing.triangles import Floats

Pixels = npt.NDArray[np.uint8]
Ints = npt.NDArray[np.int64]
#: Lines of words in the picture's upper left corner.
Labels = Sequence[str]

#: A pixel is the mean of so many squared.
_FINER = 2
_AMBIENT, _DIFFUSE, _FROM_EYE = 0.42, 0.5, 0.16
_EDGE = 0.55
_INK, _WAY = "#1c2330", "#1f6feb"


def picture(
    robot: Body,
    size_px: int = 500,
    height_m: float = 0.0,
    ways: Sequence[Floats] = (),
    labels: Labels = (),
) -> Pixels:
    """Draw it, uint8 (size, size, 3).

    Args:
        height_m: of the ground.
        ways: lines on the ground, float64 (n, 2) each; all of them are in the picture.
        labels: words.
    """
    lines = [_on_ground(way, height_m) for way in ways]
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


def _on_ground(way: Floats, height_m: float) -> Floats:
    return np.column_stack((way, np.full(len(way), height_m)))


def _paint(
    painted: Floats,
    robot: Body,
    chosen: Ints,
    camera: Camera,
    before: npt.NDArray[np.bool_] | None,
) -> None:
    """Paint some triangles over what is there.

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
    """Darker where one link ends and another begins, or nothing."""
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


def _labelled(pixels: Pixels, labels: Labels) -> Pixels:
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
