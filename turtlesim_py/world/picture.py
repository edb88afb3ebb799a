"""The window of the original as a picture: background, what the pens drew, turtles on top."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache, lru_cache
from math import ceil, cos, floor, isfinite, radians, sin
from typing import Final

import numpy as np
from numpy.typing import NDArray

from turtlesim_py.world.canvas import Canvas
from turtlesim_py.world.floats import PI
from turtlesim_py.world.turtle import SPRITES, Sprite

Color = tuple[int, int, int]
Mask = NDArray[np.bool_]
Field = NDArray[np.float64]

#: cos and sin where Qt has them ready [deg]. A heading of 0 has to give a sharp picture.
_QUARTER_TURNS = {
    90.0: (0.0, 1.0),
    -270.0: (0.0, 1.0),
    180.0: (-1.0, 0.0),
    270.0: (0.0, -1.0),
    -90.0: (0.0, -1.0),
}


def render(
    canvas: Canvas, background: tuple[int, int, int], turtles: Iterable[Sprite]
) -> NDArray[np.uint8]:
    """Return the window, RGB, shape (height, width, 3).

    Args:
        canvas: what the pens drew; where it is unpainted, the background shows.
        background: r, g, b, each from 0 to 255.
        turtles: the last one is on top. What lies outside of the window is cut off.
    """
    pixels = canvas.rgba()
    whole_pixels = pixels.view(np.uint32)[..., 0]  # assigned at once: four times as fast
    whole_pixels[pixels[..., 3] == 0] = np.array((*background, 255), np.uint8).view(np.uint32)[0]
    window = np.ascontiguousarray(pixels[..., :3])
    for turtle in turtles:
        clockwise_deg = -turtle.heading_rad * 180.0 / PI + 90.0
        if isfinite(clockwise_deg):
            picture = _rotated(turtle.name, clockwise_deg)
            _lay_over(
                window,
                picture,
                left=_first_pixel(turtle.x_px, picture.shape[1]),
                top=_first_pixel(turtle.y_px, picture.shape[0]),
            )
    return window


def _first_pixel(center: float, size: int) -> int:
    """Place a picture: where its first row or column lies, by Qt's rounding (halves up)."""
    return floor(center - 0.5 * size + 0.5) if isfinite(center) else 0


def _lay_over(window: NDArray[np.uint8], picture: NDArray[np.uint8], left: int, top: int) -> None:
    """Blend an RGBA picture into the window, as far as it lies inside."""
    height, width = window.shape[:2]
    picture = picture[max(-top, 0) : max(height - top, 0), max(-left, 0) : max(width - left, 0)]
    top, left = max(top, 0), max(left, 0)
    below = window[top : top + picture.shape[0], left : left + picture.shape[1]]
    color, alpha = picture[..., :3].astype(np.int64), picture[..., 3:].astype(np.int64)
    below[:] = (color * alpha + below * (255 - alpha) + 127) // 255


@lru_cache(maxsize=64)  # turtles that stand still, and all that are drawn twice
def _rotated(name: str, clockwise_deg: float) -> NDArray[np.uint8]:
    """Turn a picture whose head is up, without smoothing.

    The result is the smallest box around the turned square, as QImage.transformed makes it: each
    pixel gets the colour at the place where its centre comes from.
    """
    upright = sprite(name)
    size = upright.shape[0]
    angle = radians(clockwise_deg)
    c, s = _QUARTER_TURNS.get(clockwise_deg) or (cos(angle), sin(angle))
    corners_x = (0.0, c * size, -s * size, c * size - s * size)
    corners_y = (0.0, s * size, c * size, s * size + c * size)
    y, x = np.mgrid[
        floor(min(corners_y)) : ceil(max(corners_y)), floor(min(corners_x)) : ceil(max(corners_x))
    ]
    from_x = np.floor(c * (x + 0.5) + s * (y + 0.5)).astype(np.int64)
    from_y = np.floor(c * (y + 0.5) - s * (x + 0.5)).astype(np.int64)
    inside = (from_x >= 0) & (from_x < size) & (from_y >= 0) & (from_y < size)
    turned = np.zeros((*x.shape, 4), np.uint8)
    turned[inside] = upright[from_y[inside], from_x[inside]]
    return turned


# The turtles' pictures ----------------------------------------------------------------------------
#
# Eleven pictures drawn by code, under the names of turtlesim 1.8.4: a turtle seen from above,
# its head up, 45 x 45 pixels, since the original uses the height of its pictures as the length of
# a metre. Shapes are judged at 8 x 8 points in each pixel, by IEEE sums, products and square roots
# only, so that the pictures are the same bytes on every machine.

#: Edge of a picture [px].
SIZE_PX: Final = 45
_POINTS = 8  # along the edge of a pixel
_Y, _X = (np.mgrid[: SIZE_PX * _POINTS, : SIZE_PX * _POINTS] + 0.5) / _POINTS
_MIDDLE = SIZE_PX / 2.0
_SIDES = (-1.0, 1.0)

# The shell, an ellipse: centre and radii [px]
_SHELL_X, _SHELL_Y = _MIDDLE, 23.8
_SHELL_RX, _SHELL_RY = 13.0, 14.4
_OUTLINE_PX = 1.1

_WHITE: Color = (255, 255, 255)
_PUPIL: Color = (22, 24, 32)


@dataclass(frozen=True)
class Appearance:
    """How a turtle's picture differs from another's.

    Attributes:
        skin, shell, mark, line: colours; `mark` for the pattern on the shell, `line` for outlines.
        pattern: covers the marked points of the shell.
    """

    skin: Color
    shell: Color
    mark: Color
    line: Color
    pattern: Callable[[], Mask]


def _ellipse(
    x: float, y: float, rx: float, ry: float, tilt: tuple[float, float] = (1.0, 0.0)
) -> Mask:
    """Cover an ellipse around (x, y) [px]; `tilt` is the direction of rx, a vector of length 1."""
    along = (_X - x) * tilt[0] + (_Y - y) * tilt[1]
    across = (_Y - y) * tilt[0] - (_X - x) * tilt[1]
    covered: Mask = (along / rx) * (along / rx) + (across / ry) * (across / ry) <= 1.0
    return covered


def _shell(grow: float = 0.0) -> Mask:
    return _ellipse(_SHELL_X, _SHELL_Y, _SHELL_RX + grow, _SHELL_RY + grow)


def _limbs(grow: float = 0.0) -> Mask:
    """Cover head, neck, tail and legs, each larger by `grow` [px]."""
    limbs = _ellipse(_MIDDLE, 6.9, 5.2 + grow, 5.7 + grow)
    limbs |= _ellipse(_MIDDLE, 11.5, 3.4 + grow, 5.0 + grow)
    limbs |= _ellipse(_MIDDLE, 39.5, 1.5 + grow, 3.8 + grow)
    for side in _SIDES:
        limbs |= _ellipse(_MIDDLE + side * 13.3, 13.4, 7.3 + grow, 3.6 + grow, (side * 0.8, -0.6))
        limbs |= _ellipse(_MIDDLE + side * 11.3, 35.4, 5.9 + grow, 3.3 + grow, (side * 0.6, 0.8))
    return limbs


def _draw(of: Appearance) -> NDArray[np.uint8]:
    """Lay opaque shapes one over another, and average the points of each pixel.

    Alpha is the share of these that is covered.
    """
    shapes = [(_limbs(_OUTLINE_PX), of.line), (_limbs(), of.skin)]
    for side in _SIDES:
        shapes.append((_ellipse(_MIDDLE + side * 3.0, 5.2, 1.7, 2.0), _WHITE))
        shapes.append((_ellipse(_MIDDLE + side * 2.9, 4.6, 1.05, 1.25), _PUPIL))
    shapes += [(_shell(_OUTLINE_PX), of.line), (_shell(), of.shell)]
    shapes.append((of.pattern() & _shell(-1.5), of.mark))
    points, covered = np.zeros((*_X.shape, 3), np.int64), np.zeros(_X.shape, np.bool_)
    for shape, color in shapes:
        points[shape] = color
        covered |= shape
    blocks = (SIZE_PX, _POINTS, SIZE_PX, _POINTS)
    count = covered.reshape(blocks).sum(axis=(1, 3))
    divisor = np.maximum(count, 1)[..., None]
    rgb = (points.reshape(*blocks, 3).sum(axis=(1, 3)) + divisor // 2) // divisor
    alpha = (count * 255 + _POINTS**2 // 2) // _POINTS**2
    return np.dstack((rgb, alpha)).astype(np.uint8)


# Patterns, as if the shell went on for ever


def _plates(centers: list[tuple[float, float]]) -> Mask:
    """Cover what is nearer to one centre, from the middle of the shell, than to all the others."""
    distances = []
    for x, y in centers:
        dx, dy = _X - (_SHELL_X + x), _Y - (_SHELL_Y + y)
        distances.append(np.sqrt(dx * dx + dy * dy))
    nearest, second = np.sort(np.stack(distances), axis=0)[:2]
    plates: Mask = second - nearest > 1.7
    return plates


def _honeycomb() -> Mask:
    around = [(side * 9.8, y) for side in _SIDES for y in (-5.6, 5.6)]
    return _plates([(0.0, -10.6), (0.0, 0.0), (0.0, 10.6), *around])


def _star() -> Mask:
    around = [(side * x, y) for side in _SIDES for x, y in ((7.5, -8.5), (11.0, 1.5), (5.0, 10.5))]
    middle = (0.0, 0.0)
    return _plates([middle, middle, *around])  # twice: the plate between two that tie is not there


def _spots() -> Mask:
    spots = _ellipse(_SHELL_X, _SHELL_Y, 3.6, 3.6)
    for side in _SIDES:
        for x, y in ((0.0, side * 9.6), (side * 7.0, 5.4), (side * 7.0, -5.4)):
            spots |= _ellipse(_SHELL_X + x, _SHELL_Y + y, 2.4, 2.4)
    return spots


def _rings() -> Mask:
    rings = np.zeros(_X.shape, np.bool_)
    for size in (9.6, 7.2, 4.8, 2.4):
        rings ^= _ellipse(_SHELL_X, _SHELL_Y, size, size * 1.1)
    return rings


def _bands() -> Mask:
    """Cover bands that bend like a roof seen from above."""
    height = _Y - _SHELL_Y + np.abs(_X - _SHELL_X) * 0.45
    bands: Mask = np.floor(height / 3.0) % 2.0 == 0.0
    return bands


def _keys() -> Mask:
    """Cover the black keys of a piano, and the gaps between the white ones."""
    keys = np.zeros(_X.shape, np.bool_)
    for x in (2.6, 7.8):
        aside = np.abs(np.abs(_X - _SHELL_X) - x)
        keys |= aside < 0.4
        keys |= (aside < 1.5) & (_Y < _SHELL_Y + 1.5)
    return keys


_APPEARANCES: Final = {
    "ardent": Appearance((236, 164, 92), (176, 36, 40), (232, 74, 52), (88, 18, 26), _honeycomb),
    "bouncy": Appearance((130, 206, 96), (244, 120, 172), (255, 196, 220), (120, 34, 84), _spots),
    "crystal": Appearance((176, 226, 232), (62, 158, 190), (190, 244, 250), (20, 70, 98), _star),
    "dashing": Appearance((120, 190, 110), (28, 44, 104), (250, 204, 60), (12, 20, 54), _bands),
    "eloquent": Appearance((214, 190, 150), (110, 54, 140), (188, 128, 216), (54, 22, 74), _rings),
    "foxy": Appearance((250, 236, 214), (226, 104, 24), (255, 178, 88), (112, 44, 10), _honeycomb),
    "galactic": Appearance((150, 132, 210), (34, 22, 66), (120, 226, 232), (14, 8, 34), _spots),
    "humble": Appearance((150, 190, 84), (112, 82, 44), (176, 140, 80), (52, 38, 20), _star),
    "iron": Appearance((170, 178, 186), (88, 96, 106), (200, 208, 214), (38, 42, 50), _bands),
    "jazzy": Appearance((92, 186, 172), (250, 244, 228), (44, 30, 62), (58, 36, 78), _keys),
    "rolling": Appearance((240, 214, 90), (20, 120, 84), (96, 206, 140), (8, 58, 44), _rings),
}


@cache
def sprite(name: str) -> NDArray[np.uint8]:
    """Return a turtle's picture, RGBA, shape (45, 45, 4), read-only.

    Raises:
        KeyError: no picture has this name.
    """
    if name not in SPRITES:
        raise KeyError(f"no turtle picture is named {name!r}, expected one of {', '.join(SPRITES)}")
    pixels = _draw(_APPEARANCES[name])
    pixels.setflags(write=False)
    return pixels
