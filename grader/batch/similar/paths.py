"""How far apart the ways of two hand-ins are, and how many others went as near.

A way is `behaviour.POINTS` points at equal steps along it, from where it began; the distance of two
is the root of the mean square of that of their points. What the exercise forces on all of them is
in both of a pair and cancels out; that many are near each other all the same is in the numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
import numpy.typing as npt

_ROWS: Final = 256

Floats = npt.NDArray[np.float64]


class Paths:
    """The ways of a class.

    Args:
        ways: of each hand-in x, y of its points [mm]; empty where it went nowhere.
    """

    def __init__(self, ways: Sequence[Sequence[int]]) -> None:
        self._who = [number for number, way in enumerate(ways) if way]
        self._place = {number: row for row, number in enumerate(self._who)}
        # Whole numbers, and their products summed up are below 2**53: floats hold them exactly,
        # so the same comes out however a machine adds them up.
        longest = max(map(len, ways), default=0)
        flat = np.array([ways[number] for number in self._who], dtype=np.float64)
        self._points = flat.reshape(len(self._who), longest)

    def distance(self, first: int, second: int) -> int | None:
        """How far two hand-ins are apart [mm]; None where one of them went nowhere."""
        if first not in self._place or second not in self._place:
            return None
        apart = self._points[self._place[first]] - self._points[self._place[second]]
        return int(self._mm(np.array([apart @ apart]))[0])

    def hands(self, first: int, second: int, within_mm: int) -> int:
        """How many hand-ins are so near one of the two, itself among them; of both the greater."""
        rows = [self._place[first], self._place[second]]
        return int((self._distances(self._points[rows]) <= within_mm).sum(axis=1).max())

    def rarely_near(self, within_mm: int, most: int) -> list[tuple[int, int]]:
        """Pairs that are so near each other, where each has so many so near it, or fewer."""
        near: dict[int, list[int]] = {}
        for begin in range(0, len(self._who), _ROWS):
            close = self._distances(self._points[begin : begin + _ROWS]) <= within_mm
            for row in np.flatnonzero(close.sum(axis=1) <= most).tolist():
                near[begin + row] = np.flatnonzero(close[row]).tolist()
        return [
            (self._who[row], self._who[other])
            for row, others in near.items()
            for other in others
            if row < other and other in near
        ]

    def _distances(self, rows: Floats) -> Floats:
        """Of some ways to all of them [mm]."""
        squares = (self._points**2).sum(axis=1)
        apart = (rows**2).sum(axis=1)[:, None] + squares - 2 * (rows @ self._points.T)
        return self._mm(apart)

    def _mm(self, squares: Floats) -> Floats:
        return np.floor(np.sqrt(squares / max(1, self._points.shape[1] // 2)))
