"""The path of turtle1 as arrays, and the words of the challenge for it: quadrant, entry, rest."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from grader.exercise.verdict import Evidence
from grader.recording.recording import Recording
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from turtlesim_py.world.events import (
    Event,
    Kill,
    Reset,
    SomeEvent,
    Spawn,
    TeleportAbsolute,
    TeleportRelative,
)
from turtlesim_py.world.floats import float32
from turtlesim_py.world.trajectory import Trajectory
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
        foreign: the calls that ended stretches, as they came.
        lost_tick: from here on the position is not a number, and the path ends; None: never.
        number: of the run, for evidence.
    """

    def __init__(self, recording: Recording, number: int = 0) -> None:
        self.trace = TurtleTrace.of(recording.trace)
        way = self.trace.trajectory()
        nowhere = ~np.isfinite((way.x, way.y, way.theta)).all(axis=0)
        self.lost_tick = int(way.ticks[np.argmax(nowhere)]) if nowhere.any() else None
        way = way[: int(np.argmax(nowhere))] if nowhere.any() else way
        self.recording = recording
        self.number = number
        self.foreign = [event for event in self.trace.events if _is_foreign(event)]
        way = _longest_stretch(way, [event.tick for event in self.foreign])
        self.ticks = way.ticks
        self.x, self.y = way.x, way.y
        self.speed, self.turning = way.linear, way.angular

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

    def calls(self, kind: type[SomeEvent]) -> list[SomeEvent]:
        """The inputs of one kind to turtle1 within the stretch."""
        if not len(self):
            return []
        first, last = self.ticks[0], self.ticks[-1]
        return [call for call in self.trace.of_kind(kind) if first <= call.tick <= last]

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


def _is_foreign(event: Event) -> bool:
    match event:
        case TeleportAbsolute(turtle=turtle) | TeleportRelative(turtle=turtle):
            return turtle == FIRST_TURTLE
        case Kill(name=name) | Spawn(name=name):
            return name == FIRST_TURTLE
    return isinstance(event, Reset)


def _moving(x: Floats, y: Floats) -> npt.NDArray[np.bool_]:
    moved = np.zeros(len(x), dtype=bool)
    moved[1:] = (np.diff(x) != 0) | (np.diff(y) != 0)
    return moved


def _longest_stretch(way: Trajectory, breaks: list[int]) -> Trajectory:
    """The part between two breaks in which the turtle moved in the most ticks."""
    cuts = [0, *np.searchsorted(way.ticks, sorted(set(breaks))).tolist(), len(way)]
    stretches = [way[first:last] for first, last in pairwise(cuts)]
    return max(stretches, key=lambda part: int(_moving(part.x, part.y).sum()))
