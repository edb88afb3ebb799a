"""The path of turtle1 as arrays, and the words of the challenge for it: quadrant, entry, rest."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from grader.exercise.verdict import Evidence
from grader.recording.recording import Recording
from turtlesim_py.world.floats import float32
from turtlesim_py.world.turtle import SIZE_M, TICK_S

CENTRE_M = SIZE_M / 2.0
NAMES = {1: "I (top right)", 2: "II (top left)", 3: "III (bottom left)", 4: "IV (bottom right)"}

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Entry:
    """The turtle came into a quadrant.

    Attributes:
        quadrant: 1 to 4, as in mathematics.
        ticks: those at which it was clearly in it until it was clearly in another.
    """

    quadrant: int
    ticks: tuple[int, ...]

    @property
    def tick(self) -> int:
        """The first tick at which it was clearly in the quadrant."""
        return self.ticks[0]

    @property
    def last_tick(self) -> int:
        """The last tick at which it was clearly in the quadrant."""
        return self.ticks[-1]

    def settled(self, patience: int) -> int:
        """The first tick clearly in the quadrant so many ticks after the entry, or later."""
        return next((t for t in self.ticks if t >= self.tick + patience), self.last_tick)


class Path:
    """Where turtle1 was in the longest stretch of a run that it drove by itself.

    A teleport, or a turtle1 that is killed, spawned or reset, ends a stretch: what is drawn that
    way is nobody's driving. Every array has one row a tick; `ticks` tells which.

    Attributes:
        foreign: the calls that ended stretches, as scenario events.
        lost_tick: from here on the position is not a number, and the path ends; None: never.
        number: of the run, for evidence.
    """

    def __init__(self, recording: Recording, number: int = 0) -> None:
        rows = recording.published.get("turtle1", np.zeros((0, 9)))
        nowhere = ~np.isfinite(rows[:, 1:4]).all(axis=1)
        self.lost_tick = int(rows[np.argmax(nowhere), 0]) if nowhere.any() else None
        rows = rows[: np.argmax(nowhere)] if nowhere.any() else rows
        self.recording = recording
        self.number = number
        self.foreign = [event for event in recording.events if _is_foreign(event)]
        rows = _longest_stretch(rows, [int(event["tick"]) for event in self.foreign])
        self.ticks = rows[:, 0].astype(np.int64)
        self.x, self.y = rows[:, 1], rows[:, 2]
        self.speed, self.turning = rows[:, 4], rows[:, 5]

    def __len__(self) -> int:
        return len(self.ticks)

    @cached_property
    def moving(self) -> npt.NDArray[np.bool_]:
        """Whether the position differs from the tick before."""
        return _moving(self.x, self.y)

    @property
    def first(self) -> int:
        """The row of the last position before the first motion, 0 without any."""
        return int(np.argmax(self.moving)) - 1 if self.moving.any() else 0

    @property
    def last(self) -> int:
        """The row of the last motion."""
        return int(len(self) - 1 - np.argmax(self.moving[::-1])) if self.moving.any() else 0

    @cached_property
    def wall(self) -> int | None:
        """The first row at which the turtle was clamped to a wall."""
        end = float32(SIZE_M)
        clamped = (self.x <= 0) | (self.y <= 0) | (self.x >= end) | (self.y >= end)
        return int(np.argmax(clamped)) if clamped.any() else None

    @property
    def free(self) -> slice:
        """The rows of the way from the first motion to the last, or to a wall."""
        end = self.last + 1 if self.wall is None else min(self.wall, self.last + 1)
        return slice(self.first + 1, max(end, self.first + 1))

    @cached_property
    def distance(self) -> Floats:
        """From the centre of the window [m]."""
        return np.hypot(self.x - CENTRE_M, self.y - CENTRE_M)

    @cached_property
    def wall_distance(self) -> Floats:
        """To the nearest wall [m]."""
        sides = [self.x, self.y, SIZE_M - self.x, SIZE_M - self.y]
        return np.asarray(np.minimum.reduce(sides))

    @property
    def stop_tick(self) -> int:
        """The tick of the last motion."""
        return int(self.ticks[self.last]) if len(self) else 0

    def calls(self, op: str) -> list[dict[str, Any]]:
        """The inputs of one kind to turtle1 within the stretch."""
        if not len(self):
            return []
        first, last = self.ticks[0], self.ticks[-1]
        return [call for call in self.recording.calls(op) if first <= call["tick"] <= last]

    def entries(self, band_m: float, centre_m: float = CENTRE_M) -> list[Entry]:
        """Every entry into a quadrant on the turtle's way, the first one included.

        Within `band_m` of a dividing line the turtle still counts for where it was before.
        """
        rows = slice(self.first, self.last + 1)
        dx, dy, ticks = self.x[rows] - centre_m, self.y[rows] - centre_m, self.ticks[rows]
        clear = np.flatnonzero((np.abs(dx) > band_m) & (np.abs(dy) > band_m))
        if not len(clear):
            return []
        quadrant = np.where(dy > 0, np.where(dx > 0, 1, 2), np.where(dx > 0, 4, 3))[clear]
        changes = np.flatnonzero(np.diff(quadrant, prepend=0))
        stays = np.split(ticks[clear], changes[1:])
        return [
            Entry(int(quadrant[start]), tuple(stay.tolist()))
            for start, stay in zip(changes, stays, strict=True)
        ]

    def at(self, tick: int, note: str) -> Evidence:
        """Evidence at a tick."""
        if not len(self):
            return Evidence(tick, round(tick * TICK_S, 3), CENTRE_M, CENTRE_M, note, self.number)
        row = int(np.clip(np.searchsorted(self.ticks, tick), 0, len(self) - 1))
        return Evidence(
            tick=int(self.ticks[row]),
            time_s=round(float(self.ticks[row]) * TICK_S, 3),
            x=round(float(self.x[row]), 3),
            y=round(float(self.y[row]), 3),
            note=note,
            run=self.number,
        )


def _is_foreign(event: dict[str, Any]) -> bool:
    match event["op"]:
        case "teleport_absolute" | "teleport_relative":
            return bool(event["turtle"] == "turtle1")
        case "kill" | "spawn":
            return bool(event["name"] == "turtle1")
        case op:
            return bool(op == "reset")


def _moving(x: Floats, y: Floats) -> npt.NDArray[np.bool_]:
    moved = np.zeros(len(x), dtype=bool)
    moved[1:] = (np.diff(x) != 0) | (np.diff(y) != 0)
    return moved


def _longest_stretch(rows: Floats, breaks: list[int]) -> Floats:
    """The rows between two breaks in which the turtle moved in the most ticks."""
    cuts = np.searchsorted(rows[:, 0], sorted(set(breaks)))
    stretches = np.split(rows, cuts)
    return max(stretches, key=lambda part: int(_moving(part[:, 1], part[:, 2]).sum()))
