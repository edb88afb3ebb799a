"""The path of turtle1 in the challenge: the longest driven stretch, quadrants, entries."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from grader.recording.recording import Recording
from grader.scenes.turtlesim.driven_path import DrivenPath
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from grader.text.message import msg
from turtlesim_py.world.events import (
    Event,
    Kill,
    Reset,
    SomeEvent,
    Spawn,
    TeleportAbsolute,
    TeleportRelative,
)
from turtlesim_py.world.trajectory import Floats
from turtlesim_py.world.turtle import SIZE_M

CENTRE_M = SIZE_M / 2.0
QUADRANTS = 4
ROMAN = {1: "I", 2: "II", 3: "III", 4: "IV"}
NAMES = {
    1: msg("I (top right)"),
    2: msg("II (top left)"),
    3: msg("III (bottom left)"),
    4: msg("IV (bottom right)"),
}


@dataclass(frozen=True)
class Visit:
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


class Path(DrivenPath):
    """The path of turtle1 in the longest stretch of a run that it drove by itself.

    A teleport, or a turtle1 that is killed, spawned or reset, ends a stretch: what is drawn that
    way is nobody's driving.

    Attributes:
        trace: all that was recorded.
        relocations: the calls that ended stretches, in order.
        lost_tick: from here on the position is not a number, and the path ends; None: never.
    """

    def __init__(self, recording: Recording, number: int = 0) -> None:
        self.trace = TurtleTrace.of(recording.trace)
        self.relocations = list(_relocations(self.trace.events))
        whole = DrivenPath(recording, self.trace.trajectory(), number)
        self.lost_tick = None if whole.lost is None else int(whole.ticks[whole.lost])
        driven = whole.until_lost().longest_stretch(event.tick for event in self.relocations)
        super().__init__(recording, driven.way, number)

    @property
    def free(self) -> slice:
        """The rows of the way from the first motion to the last, or to a wall."""
        end = self.last + 1 if self.wall is None else min(self.wall, self.last + 1)
        return slice(self.first + 1, max(end, self.first + 1))

    @cached_property
    def distance(self) -> Floats:
        """From the centre of the window [m]."""
        return self.distance_from(CENTRE_M, CENTRE_M)

    def calls(self, kind: type[SomeEvent]) -> list[SomeEvent]:
        """Return the inputs of one kind to turtle1 within the stretch."""
        if not len(self):
            return []
        first, last = self.ticks[0], self.ticks[-1]
        return [call for call in self.trace.of_kind(kind) if first <= call.tick <= last]

    def entries(self, band_m: float, centre_m: float = CENTRE_M) -> list[Visit]:
        """Return every entry into a quadrant on the turtle's way, the first one included.

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
            Visit(int(quadrant[start]), tuple(stay.tolist()))
            for start, stay in zip(changes, stays, strict=True)
        ]


def _relocations(events: Iterable[Event]) -> Iterator[Event]:
    """Yield the calls that put turtle1 somewhere; a spawn with a name in use does nothing."""
    is_there = True
    for event in events:
        match event:
            case TeleportAbsolute(turtle=name) | TeleportRelative(turtle=name):
                acts = name == FIRST_TURTLE
            case Kill(name=name):
                acts = name == FIRST_TURTLE
                is_there = is_there and not acts
            case Spawn(name=name):
                acts = name == FIRST_TURTLE and not is_there
                is_there = is_there or acts
            case Reset():
                acts = is_there = True
            case _:
                acts = False
        if acts:
            yield event
