"""The canvas that the pens draw on: strokes in, pixels and the colour under a point out."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import floor
from sys import byteorder
from typing import Self

import numpy as np
from numpy.typing import NDArray

from turtlesim_py.world.stroke import SIZE_PX, Span, spans

#: Red, green, blue, alpha of a pixel without paint: the original clears to transparent white.
UNPAINTED = (255, 255, 255, 0)


@dataclass(frozen=True)
class Pen:
    """The pen of a turtle. Each value is from 0 to 255, as in the SetPen service.

    Attributes:
        r, g, b: colour; the default is the original's.
        width: [px]. Width 0 draws like 1: the original makes a new QPen for each SetPen and does
            not set the width if it is 0, and a new QPen is 1 px wide. A pen keeps its 0 all the
            same, so that it shows what was asked for; the stroke handles it.
    """

    r: int = 0xB3
    g: int = 0xB8
    b: int = 0xFF
    width: int = 3

    def __post_init__(self) -> None:
        for name in ("r", "g", "b", "width"):
            if not 0 <= getattr(self, name) <= 255:
                raise ValueError(f"pen {name} is {getattr(self, name)}, expected 0 to 255")

    @cached_property
    def _pixel(self) -> array[int]:
        """One opaque pixel as it lies in the canvas."""
        return array("I", bytes((self.r, self.g, self.b, 255)))


class Canvas:
    """An image that starts transparent, for strokes; x to the right, y down, both in pixels.

    A pixel is painted wholly or not at all, and later strokes cover earlier ones. The turtles and
    the background are not in it: see `picture`.

    Attributes:
        watcher: called with the pen and the runs of each stroke, if there is one; a copy has none.
    """

    def __init__(self) -> None:
        self.watcher: Callable[[Pen, Sequence[Span]], None] | None = None
        # One 32-bit item a pixel, row after row, with the bytes r, g, b, a in memory: painting a
        # run is one slice assignment, and numpy reads the same bytes without conversion.
        self.clear()

    def clear(self) -> None:
        """Remove all paint."""
        self._pixels = array("I", bytes(UNPAINTED)) * SIZE_PX**2

    def copy(self) -> Self:
        """Return a canvas with the same pixels that later strokes do not change."""
        twin = type(self)()
        twin._pixels = self._pixels[:]
        return twin

    def draw_line(self, ax: float, ay: float, bx: float, by: float, pen: Pen) -> None:
        """Draw a line from a to b [px], or a dot where they are equal.

        For a turtle, a is the new position and b the old one: the order decides some pixels.
        Coordinates may be far outside; with one that is not finite nothing is drawn.
        """
        self.paint(pen, spans(ax, ay, bx, by, pen.width))

    def paint(self, pen: Pen, runs: Sequence[Span]) -> None:
        """Paint runs of pixels, all of them within the canvas."""
        pixels, pixel = self._pixels, pen._pixel
        for row, first, last in runs:
            start = row * SIZE_PX
            pixels[start + first : start + last + 1] = pixel * (last - first + 1)
        if self.watcher is not None:
            self.watcher(pen, runs)

    def color_at(self, x: float, y: float) -> tuple[int, int, int]:
        """Read the colour (r, g, b) under a point [px]: what the colour sensor publishes.

        A coordinate is rounded to a pixel number like the original's, halves up, and counts as 0 if
        it is not a number. White where nothing is painted and outside of the canvas.
        """
        # Compared before it is rounded, because infinity cannot be rounded.
        column = x + 0.5 if x == x else 0.0
        row = y + 0.5 if y == y else 0.0
        if not (0.0 <= column < SIZE_PX and 0.0 <= row < SIZE_PX):
            return UNPAINTED[:3]
        pixel = self._pixels[floor(row) * SIZE_PX + floor(column)]
        r, g, b, _ = pixel.to_bytes(4, byteorder)
        return r, g, b

    def rgba(self) -> NDArray[np.uint8]:
        """Return a copy of the pixels, shape (500, 500, 4); unpainted is 255, 255, 255, 0."""
        pixels = np.frombuffer(self._pixels, dtype=np.uint8)
        return pixels.reshape(SIZE_PX, SIZE_PX, 4).copy()
