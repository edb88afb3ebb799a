"""The way of turtle1, simplified to straight sides as one would draw it with a ruler.

It ends where turtle1 first returns to its start, so that a node which only forgets to stop has
still drawn its square.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from grader.exercise.check import Tolerances
from grader.exercise.driven_path import DrivenPath, Side
from grader.message import NOTHING, msg
from grader.recording.recording import Recording
from grader.scenes.turtlesim.trace import USUAL_START, TurtleTrace, stands_still
from turtlesim_py.world.events import CmdVel
from turtlesim_py.world.trajectory import Floats

#: A shorter step is no motion: the pose that was set and the published one differ by rounding [m].
STILL_M = 1e-5
#: Two sides that meet at the start with less of a turn are one side, begun in its middle [deg].
SAME_SIDE_DEG = 30.0
#: The row of a command's own tick shows what it did: after a stop at tick t the last row that
#: differs from the one before is t - 1.
STOP_SHOWS = 1


@dataclass(frozen=True)
class Corner:
    """A corner between two sides."""

    index: int
    turn_deg: float


class Way(DrivenPath):
    """The path of turtle1, from where it drove off until the end of the recording.

    Attributes:
        tolerances: of the exercise.
        commands: that came to turtle1.
        broken_by: why the way ends before the recording does; nothing where it does not.
        moved_away: whether it was put somewhere else before it drove off.
    """

    def __init__(self, recording: Recording, tolerances: Tolerances, number: int = 0) -> None:
        self.tolerances = tolerances
        self.broken_by = NOTHING
        trace = TurtleTrace.of(recording.trace)
        self.commands = trace.of_kind(CmdVel)
        whole = DrivenPath(recording, trace.trajectory(), number)
        if whole.lost is not None:
            self.broken_by = msg("its pose was no number any more")
        path = whole.until_lost().begun_at(recording.start or USUAL_START)
        driven = (path.steps_m > STILL_M) & ~path.jumping
        first = int(np.argmax(driven)) - 1 if driven.any() else len(path) - 1
        self.moved_away = bool(path.jumping[: first + 1].any())
        later = np.flatnonzero(path.jumping[first + 1 :])
        end = None
        if later.size:
            end = first + 1 + int(later[0])
            self.broken_by = msg("it jumped to another place")
        super().__init__(recording, path.way[first:end], number)

    @property
    def rests(self) -> bool:
        """Whether it stands still at the end."""
        return bool(self.rested_s >= self.tolerances["rest_s"])

    @cached_property
    def gap_m(self) -> Floats:
        """The distance from the start [m], float64 (n,)."""
        return self.distance_from(self.x[0], self.y[0])

    @cached_property
    def lap_end(self) -> int | None:
        """The row of its first return, after it had been half a side away; None for none."""
        gaps = self.gap_m
        away = np.flatnonzero(gaps > self.tolerances["side_m"] / 2)
        if not away.size:
            return None
        near = gaps <= self.tolerances["return_m"]
        near[: away[0]] = False
        if not near.any():
            return None
        arrival = int(np.argmax(near))
        gone = np.flatnonzero(~near[arrival:])
        departure = arrival + int(gone[0]) if gone.size else len(gaps)
        return arrival + int(np.argmin(gaps[arrival:departure]))

    @cached_property
    def sides(self) -> list[Side]:
        """The straight pieces of its first round."""
        lap = self if self.lap_end is None else self.part(slice(self.lap_end + 1))
        found = lap.straight_pieces(self.tolerances["corner_size_m"])
        if self._leads_back(found) and abs(found[-1].turn_deg(found[0])) < SAME_SIDE_DEG:
            end, begin = found.pop(), found[0]
            worse = max(end, begin, key=lambda side: side.crooked_m)
            found[0] = replace(worse, vector=end.vector + begin.vector, last=begin.last)
        return found

    @property
    def corners(self) -> list[Corner]:
        """The corners of its sides; the start is one of them if the way leads back to it."""
        pairs = list(pairwise(self.sides))
        if self._leads_back(self.sides):
            pairs.append((self.sides[-1], self.sides[0]))
        return [Corner(before.last, before.turn_deg(after)) for before, after in pairs]

    def _leads_back(self, found: list[Side]) -> bool:
        gap = np.hypot(*np.sum([side.vector for side in found], axis=0)) if found else math.inf
        return len(found) > 2 and bool(gap < self.tolerances["side_m"] / 2)

    def stop_command(self) -> int | None:
        """Return the tick of the command that stopped turtle1, if one did."""
        found = None
        for command in reversed(self.commands):
            if not stands_still(command):
                break
            found = command.tick
        last_motion = int(self.ticks[self.rest])
        return found if found is not None and found <= last_motion + STOP_SHOWS else None

    def stopped_and_drove_on(self) -> tuple[CmdVel, CmdVel] | None:
        """Find the first command to stop after the return, near the start, and the one after it."""
        if self.lap_end is None:
            return None
        since = int(self.ticks[self.lap_end])
        for stop, further in pairwise(self.commands):
            is_near = self.gap_m[self.row_at(stop.tick)] <= self.tolerances["near_m"]
            is_back = stop.tick + STOP_SHOWS >= since and is_near
            if is_back and stands_still(stop) and not stands_still(further):
                return stop, further
        return None
