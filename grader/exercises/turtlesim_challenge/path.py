"""The path of turtle1 as arrays, and the words of the challenge for it: quadrant, turn, rest."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from grader.recording import Recording
from grader.verdict import Evidence
from turtlesim_py.world.turtle import SIZE_M, TICK_S

CENTRE_M = SIZE_M / 2.0
NAMES = {1: "I (top right)", 2: "II (top left)", 3: "III (bottom left)", 4: "IV (bottom right)"}

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Entry:
    """The turtle came into a quadrant.

    Attributes:
        quadrant: 1 to 4, as in mathematics.
        left_tick: the last tick at which it was clearly in the quadrant before.
        tick: the first tick at which it was clearly in this one.
        last_tick: the last tick at which it was clearly in this one.
    """

    quadrant: int
    left_tick: int
    tick: int
    last_tick: int


class Path:
    """Where turtle1 was; every array has one row a tick, row 0 being tick 1."""

    def __init__(self, recording: Recording) -> None:
        rows = recording.published.get("turtle1", np.zeros((0, 9)))
        self.recording = recording
        self.ticks = rows[:, 0].astype(np.int64)
        self.x, self.y, self.theta = rows[:, 1], rows[:, 2], rows[:, 3]
        self.speed, self.turning = rows[:, 4], rows[:, 5]

    def __len__(self) -> int:
        return len(self.ticks)

    @cached_property
    def moving(self) -> npt.NDArray[np.bool_]:
        """Whether the position differs from the tick before."""
        moved = np.zeros(len(self), dtype=bool)
        moved[1:] = (np.diff(self.x) != 0) | (np.diff(self.y) != 0)
        return moved

    @property
    def first(self) -> int:
        """The row of the last position before the first motion, 0 without any."""
        return int(np.argmax(self.moving)) - 1 if self.moving.any() else 0

    @property
    def last(self) -> int:
        """The row of the last motion."""
        return int(len(self) - 1 - np.argmax(self.moving[::-1])) if self.moving.any() else 0

    @cached_property
    def distance(self) -> Floats:
        """From the centre [m]."""
        return np.hypot(self.x - CENTRE_M, self.y - CENTRE_M)

    @cached_property
    def wall_distance(self) -> Floats:
        """To the nearest wall [m]."""
        sides = [self.x, self.y, SIZE_M - self.x, SIZE_M - self.y]
        return np.asarray(np.minimum.reduce(sides))

    def quadrants(self, band_m: float = 0.0) -> npt.NDArray[np.int64]:
        """The quadrant of each row; within `band_m` of a dividing line, the one before lasts.

        0 until the turtle has once been clearly in a quadrant.
        """
        dx, dy = self.x - CENTRE_M, self.y - CENTRE_M
        clear = (np.abs(dx) > band_m) & (np.abs(dy) > band_m)
        raw = np.where(dy > 0, np.where(dx > 0, 1, 2), np.where(dx > 0, 4, 3))
        index = np.maximum.accumulate(np.where(clear, np.arange(len(self)), -1))
        return np.where(index >= 0, raw[np.maximum(index, 0)], 0)

    def entries(self, band_m: float) -> list[Entry]:
        """Every entry into a quadrant while the turtle was on its way, the first one included."""
        quadrants = self.quadrants(band_m)[: self.last + 1]
        dx, dy = np.abs(self.x - CENTRE_M), np.abs(self.y - CENTRE_M)
        clear = np.flatnonzero((dx > band_m) & (dy > band_m))
        changes = np.flatnonzero(np.diff(quadrants, prepend=0))
        bounds = [*changes, self.last + 1]
        # The last row before each bound at which the turtle was clearly in a quadrant.
        until = [
            int(self.ticks[clear[clear < bound][-1]]) if bound > clear[0] else 0 for bound in bounds
        ]
        return [
            Entry(int(quadrants[row]), until[i], int(self.ticks[row]), until[i + 1])
            for i, row in enumerate(changes)
        ]

    def at(self, tick: int, note: str) -> Evidence:
        """Evidence at a tick."""
        row = min(max(tick - 1, 0), len(self) - 1)
        return Evidence(
            tick=int(self.ticks[row]),
            time_s=round(float(self.ticks[row]) * TICK_S, 3),
            x=round(float(self.x[row]), 3),
            y=round(float(self.y[row]), 3),
            note=note,
        )
