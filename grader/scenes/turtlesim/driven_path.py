"""The path that something drove, as arrays, and measures of it: where, how far, when.

Made for checks: an exercise derives a class of its own that adds the words of its task, or uses
this one as it is. Nothing here raises for what a submission can do: a path may be empty, may have
gaps in its ticks, and may end nowhere.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from grader.recording.evidence import Evidence
from grader.recording.recording import Recording
from grader.recording.subject import Start
from grader.text.message import Message, msg
from turtlesim_py.world.trajectory import Floats, Trajectory
from turtlesim_py.world.turtle import SIZE_M, TICK_S

Mask = npt.NDArray[np.bool_]

#: A step that is longer by this than its speed explains is a jump [m].
JUMP_M = 0.001
#: Two pieces that meet at the start with less of a turn are one, begun in its middle [deg].
SAME_SIDE_DEG = 30.0
#: How often corners are improved; a polygon needs two or three passes.
MOST_PASSES = 10
#: A path with more corners was not meant as a polygon, and is not simplified any further.
MOST_CORNERS = 300


@dataclass(frozen=True)
class Side:
    """A straight piece of a path.

    Attributes:
        vector: from its beginning to its end [m], float64 (2,).
        last: the row of its end.
        crooked_m: how far the path lies beside it at most [m].
        crooked_at: the row where it does.
        turn_deg: by how much the path turns in the corner at its end, to the left [deg]; None: the
            path ends there.
    """

    vector: Floats
    last: int
    crooked_m: float
    crooked_at: int
    turn_deg: float | None = None

    @property
    def length_m(self) -> float:
        """From corner to corner."""
        return float(np.hypot(*self.vector))

    def turn_to_deg(self, following: Side) -> float:
        """By how much the path turns from this side to the following, to the left [deg]."""
        (a, b), (c, d) = self.vector, following.vector
        return math.degrees(math.atan2(a * d - b * c, a * c + b * d))


class DrivenPath:
    """A trajectory in a square arena that reaches from 0 to `size_m` on both axes.

    A row is an index of its arrays; each holds n readings.

    Attributes:
        recording: what it is from.
        number: of the run, for evidence: 0 is the nominal one.
        way: the trajectory itself.
        ticks: when, int64 (n,).
        x, y: where [m], float64 (n,).
        theta: the heading [rad], float64 (n,).
        linear, angular: the published speeds [m/s, rad/s], float64 (n,).
        tick_s: the length of a tick [s].
        size_m: the edge of the arena [m].
    """

    def __init__(self, recording: Recording, way: Trajectory, number: int = 0) -> None:
        self.recording = recording
        self.number = number
        self.way = way
        self.ticks = way.ticks
        self.x, self.y, self.theta = way.x, way.y, way.theta
        self.linear, self.angular = way.linear, way.angular
        self.tick_s = TICK_S
        self.size_m = SIZE_M

    def __len__(self) -> int:
        return len(self.ticks)

    # Parts of it ------------------------------------------------------------------------------

    def part(self, rows: slice | Mask) -> DrivenPath:
        """Return a part of the path: the readings at some rows."""
        return DrivenPath(self.recording, self.way[rows], self.number)

    def begun_at(self, start: Start) -> DrivenPath:
        """Return the path with one reading more in front: at tick 0 it stood at rest at its start.

        The first reading of a recording lies after the first tick, which may have moved it.
        """
        pose = np.array((start.x, start.y, start.theta), dtype=np.float32)
        row = np.array((0, *pose, 0, 0, 0, 0, 0), dtype=np.float64)
        way = Trajectory.of_rows(np.vstack((row, self.way.rows())))
        return DrivenPath(self.recording, way, self.number)

    def until_lost(self) -> DrivenPath:
        """Return the path up to the first pose that is not a number."""
        return self.part(slice(self.lost))

    def stretches(self, ticks: Iterable[int]) -> list[DrivenPath]:
        """Split the path at these ticks; some of the parts may be empty."""
        cuts = [0, *np.searchsorted(self.ticks, sorted(set(ticks))).tolist(), len(self)]
        return [self.part(slice(first, last)) for first, last in pairwise(cuts)]

    def longest_stretch(self, ticks: Iterable[int]) -> DrivenPath:
        """Return that of its `stretches` which moved in the most ticks."""
        return max(self.stretches(ticks), key=lambda part: int(part.moving.sum()))

    def between_jumps(self, still_m: float = 1e-5) -> DrivenPath:
        """Return the path from where it first drove, by steps over `still_m` [m], to the next jump.

        A pose that was set and the published one differ by rounding. Without any driving it is the
        last reading.
        """
        driven = (self.steps_m > still_m) & ~self.jumping
        first = int(np.argmax(driven)) - 1 if driven.any() else len(self) - 1
        jumps = np.flatnonzero(self.jumping)
        return self.part(slice(first, next(iter(jumps[jumps > first]), None)))

    # Motion -----------------------------------------------------------------------------------

    @cached_property
    def lost(self) -> int | None:
        """The row of the first pose that is not a number; None: it was somewhere all the time."""
        nowhere = ~np.isfinite((self.x, self.y, self.theta)).all(axis=0)
        return int(np.argmax(nowhere)) if nowhere.any() else None

    @cached_property
    def steps_m(self) -> Floats:
        """The distance to the reading before [m], 0 for the first; float64 (n,)."""
        steps = np.zeros(len(self))
        with np.errstate(invalid="ignore"):  # a path that is not cut may hold infinities
            steps[1:] = np.hypot(np.diff(self.x), np.diff(self.y))
        return steps

    @cached_property
    def moving(self) -> Mask:
        """Whether the position differs from the reading before; bool (n,)."""
        return _changes(self.x) | _changes(self.y)

    @cached_property
    def jumping(self) -> Mask:
        """Whether the step from the reading before is longer than its speed explains; bool (n,)."""
        return self.steps_m > self.linear * self.tick_s + JUMP_M

    @property
    def first(self) -> int:
        """The row of the last position before the first motion, 0 without any."""
        return int(np.argmax(self.moving)) - 1 if self.moving.any() else 0

    @property
    def last(self) -> int:
        """The row of the last motion, 0 without any."""
        return _last(self.moving)

    @property
    def stop_tick(self) -> int:
        """The tick of the last motion; 0 where there is nothing at all."""
        return int(self.ticks[self.last]) if len(self) else 0

    @cached_property
    def rest(self) -> int:
        """The row from which on it neither moves nor turns, to the end."""
        return _last(self.moving | _changes(self.theta))

    @property
    def rested_s(self) -> float:
        """For how long it has neither moved nor turned at the end [s]."""
        return float((self.ticks[-1] - self.ticks[self.rest]) * self.tick_s) if len(self) else 0.0

    @cached_property
    def driven_m(self) -> Floats:
        """The length of the path up to each reading [m], float64 (n,)."""
        return np.cumsum(self.steps_m)

    @property
    def length_m(self) -> float:
        """The length of the whole path [m]."""
        return float(self.driven_m[-1]) if len(self) else 0.0

    def length_from(self, row: int) -> float:
        """Return the length of the path from a row to the end [m]."""
        return float(self.driven_m[-1] - self.driven_m[row])

    def first_return(self, near_m: float, away_m: float) -> int | None:
        """Return the row at which it first came back to its start, None if it never did.

        It was farther than `away_m` from it [m] before. Of the rows from then on that lie within
        `near_m` [m] without a gap, it is the nearest.
        """
        gaps = np.hypot(*(self.points - self.points[:1]).T)
        back = np.flatnonzero((gaps <= near_m) & np.logical_or.accumulate(gaps > away_m))
        first = back[back == np.arange(len(back)) + back[:1]]
        return int(first[np.argmin(gaps[first])]) if len(first) else None

    def sides(self, error_m: float, closed_m: float = 0.0) -> list[Side]:
        """Approximate the path by straight lines that lie `error_m` [m] at most beside it.

        Three or more that end less than `closed_m` [m] from where they begin are a polygon: there
        the last one turns into the first, or, by less than `SAME_SIDE_DEG`, is one with it.
        """
        marks = simplify(self.points, error_m) if len(self) else []
        found = [
            Side(self.points[b] - self.points[a], b, beside_m, at)
            for a, b in pairwise(marks)
            for at, beside_m in [farthest(self.points, a, b)]
        ]
        gap = np.sum([side.vector for side in found], axis=0)
        closed = len(found) > 2 and bool(np.hypot(*gap) < closed_m)
        if closed and abs(found[-1].turn_to_deg(found[0])) < SAME_SIDE_DEG:
            *found, end = found
            worse = max(end, found[0], key=lambda side: side.crooked_m)
            vector = end.vector + found[0].vector
            found[0] = replace(worse, vector=vector, last=found[0].last)
            closed = len(found) > 2
        corners = list(zip(found, found[1:] + found[:closed], strict=False))
        turning = [replace(side, turn_deg=side.turn_to_deg(after)) for side, after in corners]
        return turning + found[len(corners) :]

    # Places -----------------------------------------------------------------------------------

    @cached_property
    def points(self) -> Floats:
        """The positions [m], float64 (n, 2)."""
        return np.column_stack((self.x, self.y))

    def distance_from(self, x: float, y: float) -> Floats:
        """Return the distance of each reading from a place [m], float64 (n,)."""
        return np.hypot(self.x - x, self.y - y)

    @cached_property
    def to_walls(self) -> Floats:
        """The distances to the left, bottom, right and top wall [m], float64 (n, 4)."""
        return np.column_stack((self.x, self.y, self.size_m - self.x, self.size_m - self.y))

    @cached_property
    def wall_distance(self) -> Floats:
        """The distance to the nearest wall [m], float64 (n,)."""
        return np.asarray(self.to_walls.min(axis=1))

    @cached_property
    def wall(self) -> int | None:
        """The first row at which a wall stopped it; None: none did."""
        clamped = (self.x <= 0) | (self.y <= 0) | (self.x >= self.size_m) | (self.y >= self.size_m)
        return int(np.argmax(clamped)) if clamped.any() else None

    def row_at(self, tick: int) -> int:
        """Return the row of the first reading at or after a tick, or of the last one."""
        return int(np.clip(np.searchsorted(self.ticks, tick), 0, len(self) - 1))

    def place(self, row: int) -> Message:
        """Return the position at a row, in words."""
        return msg("({x:.2f}, {y:.2f})", x=self.x[row], y=self.y[row])

    def evidence(self, row: int, note: Message) -> Evidence:
        """Make evidence of the place and time at a row; -1 is the last."""
        tick = int(self.ticks[row])
        place = [round(float(each[row]), 3) for each in (self.x, self.y)]
        x, y = place if all(map(math.isfinite, place)) else (None, None)
        return Evidence(round(tick * self.tick_s, 3), note, x, y, self.number, tick)

    def at(self, tick: int, note: Message) -> Evidence:
        """Make evidence of the first reading at or after a tick, or the last one.

        Where there is no reading at all, it has no place.
        """
        if not len(self):
            return Evidence(round(tick * self.tick_s, 3), note, run=self.number, tick=tick)
        return self.evidence(self.row_at(tick), note)


def _changes(values: Floats) -> Mask:
    """Mask the values that differ from the one before."""
    changed = np.zeros(len(values), dtype=bool)
    changed[1:] = values[1:] != values[:-1]
    return changed


def _last(mask: Mask) -> int:
    """The last row where it is true, 0 without any."""
    return int(len(mask) - 1 - np.argmax(mask[::-1])) if mask.any() else 0


def simplify(points: Floats, error_m: float) -> list[int]:
    """Return the points to keep so that all lie within `error_m` of the lines between them.

    The algorithm of Ramer, Douglas and Peucker finds as many as are needed or a few more, and not
    quite in the corners: a side that is parallel to its line of sight is farthest everywhere. So
    each is then improved between its neighbours.
    """
    keep = {0, len(points) - 1}
    pending = [(0, len(points) - 1)]
    while pending and len(keep) <= MOST_CORNERS:
        first, last = pending.pop()
        middle, beside = farthest(points, first, last)
        if beside > error_m:
            keep.add(middle)
            pending += [(first, middle), (middle, last)]
    marks = sorted(keep)
    for _ in range(MOST_PASSES):
        before = list(marks)
        for mark in before[1:-1]:
            at = marks.index(mark)
            better, beside = farthest(points, marks[at - 1], marks[at + 1])
            marks[at : at + 1] = [better] if beside > error_m else []
        if marks == before:
            break
    return marks


def farthest(points: Floats, first: int, last: int) -> tuple[int, float]:
    """Return the index of the point farthest from the line between two, and its distance [m]."""
    from_first, along = points[first : last + 1] - points[first], points[last] - points[first]
    square = float(along @ along) or 1.0
    share = np.clip(from_first @ along / square, 0.0, 1.0)
    beside = np.hypot(*(from_first - share[:, None] * along).T)
    at = int(np.argmax(beside))
    return first + at, float(beside[at])
