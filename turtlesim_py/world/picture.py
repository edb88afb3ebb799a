"""The window of the original as a picture: background, what the pens drew, turtles on top."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache, lru_cache
from importlib.resources import files
from math import ceil, cos, floor, isfinite, radians, sin

import numpy as np
from numpy.typing import NDArray

from turtlesim_py.world.canvas import Canvas
from turtlesim_py.world.floats import PI
from turtlesim_py.world.turtle import SPRITES, Sprite

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


@cache
def sprite(name: str) -> NDArray[np.uint8]:
    """Return a turtle's picture, RGBA, shape (45, 45, 4), read-only.

    turtles.png has them in a row, in the order of `SPRITES`: turtles seen from above, their heads
    up. The original uses the height of its pictures as the length of a metre.

    Raises:
        KeyError: no picture has this name.
    """
    import PIL.Image  # here: few draw a turtle

    if name not in SPRITES:
        raise KeyError(f"no turtle picture is named {name!r}, expected one of {', '.join(SPRITES)}")
    with (files(__package__) / "turtles.png").open("rb") as file:
        row = np.asarray(PIL.Image.open(file))
    left = SPRITES.index(name) * row.shape[0]
    pixels = row[:, left : left + row.shape[0]].copy()
    pixels.setflags(write=False)
    return pixels
