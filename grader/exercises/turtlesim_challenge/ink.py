"""What the picture shows in each quarter of the window."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

#: A band around the dividing lines in which colours may mix [px]: a late answer and a pen's width.
BAND_PX = 20
#: A quarter with less ink than this shows no spiral [px].
LEAST_PIXELS = 100


@dataclass(frozen=True)
class Quarter:
    """The ink of a quarter: how many pixels, the main colour, and its share of them."""

    pixels: int
    color: tuple[int, ...]
    share: float


def quarters(canvas: npt.NDArray[np.uint8]) -> dict[int, Quarter]:
    """Look at the four quarters of a canvas (height, width, 4); quadrant -> ink."""
    height, width = canvas.shape[:2]
    top, bottom = slice(0, height // 2 - BAND_PX), slice(height // 2 + BAND_PX, height)
    left, right = slice(0, width // 2 - BAND_PX), slice(width // 2 + BAND_PX, width)
    parts = {1: (top, right), 2: (top, left), 3: (bottom, left), 4: (bottom, right)}
    return {quadrant: _look(canvas[rows, columns]) for quadrant, (rows, columns) in parts.items()}


def _look(part: npt.NDArray[np.uint8]) -> Quarter:
    ink = part[part[..., 3] > 0][:, :3]
    if not len(ink):
        return Quarter(0, (), 0.0)
    colors, counts = np.unique(ink, axis=0, return_counts=True)
    main = int(np.argmax(counts))
    return Quarter(len(ink), tuple(int(v) for v in colors[main]), float(counts[main]) / len(ink))
