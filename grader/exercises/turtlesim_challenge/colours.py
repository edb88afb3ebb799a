"""Compares colours as an eye does, and names them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from grader.scenes.turtlesim import words
from grader.text.message import Message, in_context, msg
from turtlesim_py.world.canvas import Pen
from turtlesim_py.world.trajectory import Floats

Color = tuple[int, int, int]

#: The colour of a pen that was never set.
FIRST: Color = (Pen.r, Pen.g, Pen.b)

# sRGB to XYZ (IEC 61966-2-1), and the white D65 that it goes with
_TO_XYZ = np.array(
    [
        [0.4124, 0.3576, 0.1805],
        [0.2126, 0.7152, 0.0722],
        [0.0193, 0.1192, 0.9505],
    ]
)
_WHITE = _TO_XYZ.sum(axis=1)


def lab(colors: npt.ArrayLike) -> Floats:
    """Convert sRGB colours, 0 to 255, (n, 3), to CIELAB (CIE 15:2004, 8.2.1), (n, 3)."""
    srgb = np.asarray(colors, dtype=np.float64).reshape(-1, 3) / 255.0
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    xyz = linear @ _TO_XYZ.T / _WHITE
    f = np.where(xyz > (6 / 29) ** 3, np.cbrt(xyz), xyz / (3 * (6 / 29) ** 2) + 4 / 29)
    x, y, z = f.T
    return np.column_stack((116 * y - 16, 500 * (x - y), 200 * (y - z)))


def distances(colors: npt.ArrayLike, color: Color) -> Floats:
    """Return how far colours are from one, float64 (n,): the Euclidean distance in CIELAB.

    About 2.3 is just noticeable where two areas touch (Mahy, Van Eycken, Oosterlinck 1994).
    """
    return np.asarray(np.linalg.norm(lab(colors) - lab(color), axis=1))


@lru_cache(4096)  # thousands of entries show a few colours
def alike(one: Color | None, other: Color | None, distance: float) -> bool:
    """Whether two colours look the same; None is no colour, a pen that is up."""
    if one is None or other is None:
        return one is other
    return one == other or bool(distances(other, one)[0] < distance)


def groups(colors: Mapping[int, Color | None], distance: float) -> list[list[int]]:
    """Group the quadrants that look alike; those without a colour are left out."""
    found: list[list[int]] = []
    for quadrant, color in sorted(colors.items()):
        if color is None:
            continue
        home = next((g for g in found if alike(colors[g[0]], color, distance)), None)
        if home is None:
            found.append([quadrant])
        else:
            home.append(quadrant)
    return found


def name(color: Color | None) -> Message:
    """Name a colour, as the page does: 'red (255, 0, 0)'; 'off' for none."""
    if color is None:
        return in_context("off", "of a pen")
    called = words.color(*map(int, color))
    return msg("the pen's first colour, {color}", color=called) if tuple(color) == FIRST else called
