"""Which triangle is seen in which pixel: a z-buffer, many triangles at once."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from robot_py.drawing.triangles import Floats

Ints = npt.NDArray[np.int64]

#: So many pixels are looked at in one go.
_AT_ONCE = 400_000


def nearest(pixels: Floats, ahead: Floats, size_px: int) -> tuple[Ints, Floats]:
    """Of each pixel the number of the triangle that is seen there, -1 for none.

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
    """How much of each corner is in the middle of a pixel: float64 (n, 3), all >= 0 inside."""
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
    """Triangles with the pixels of the boxes around them: number, x, y."""
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
