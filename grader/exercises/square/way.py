"""The way of turtle1, simplified to straight sides as one would draw it with a ruler.

It ends where turtle1 first returns to its start, so that a node which only forgets to stop has
still drawn its square.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Evidence
from grader.recording.recording import Recording
from grader.scenes.scene import Start
from grader.scenes.turtlesim.trace import TurtleTrace
from turtlesim_py.world.turtle import SIZE_M, TICK_S

FloatArray = npt.NDArray[np.float64]

#: A step of the turtle that is longer by this than its speed explains is a jump [m].
JUMP_M = 0.001
#: A shorter step is no motion: where it was put and what it publishes differ by rounding [m].
STILL_M = 1e-5
#: Two sides that meet at the start with less of a turn are one side, begun in its middle [deg].
SAME_SIDE_DEG = 30.0
#: How often corners are looked at again; a polygon needs two or three looks.
MOST_LOOKS = 10


@dataclass(frozen=True)
class Side:
    """A straight piece of the way; `last` and `crooked_at` are indices of it."""

    vector: FloatArray
    last: int
    crooked_m: float
    crooked_at: int

    @property
    def length_m(self) -> float:
        """From corner to corner."""
        return float(np.hypot(*self.vector))


@dataclass(frozen=True)
class Corner:
    """Where a side ends and another begins."""

    index: int
    turn_deg: float


class Way:
    """Where turtle1 drove, from where it drove off until the end of the recording.

    The first row of a recording lies after the first tick, which may have moved the turtle. So the
    way has one more in front: tick 0, where the turtle was put.

    Attributes:
        ticks, points: when and where it was; x, y [m].
        last_motion: index of the row in which it last moved or turned.
        broken_by: why the way ends before the recording does; "" where it does not.
        length_m: of all of it.
    """

    def __init__(self, recording: Recording) -> None:
        rows = TurtleTrace.of(recording.trace).trajectory().rows()
        self.broken_by = ""
        finite = np.isfinite(rows[:, 1:4]).all(axis=1)
        if not finite.all():
            rows = rows[: int(np.argmin(finite))]
            self.broken_by = "its pose was no number any more"
        rows = np.vstack((before_first_tick(recording), rows))
        steps = np.hypot(*np.diff(rows[:, 1:3], axis=0).T)
        jumped = steps > rows[1:, 4] * TICK_S + JUMP_M
        driven = (steps > STILL_M) & ~jumped
        first = int(np.argmax(driven)) if driven.any() else len(rows) - 1
        later = np.flatnonzero(jumped[first:])
        if later.size:
            rows = rows[: first + int(later[0]) + 1]
            self.broken_by = "it jumped to another place"
        rows = rows[first:]
        self.ticks: npt.NDArray[np.int64] = rows[:, 0].astype(np.int64)
        self.points: FloatArray = rows[:, 1:3]
        self._driven_m: FloatArray = np.concatenate(
            ([0.0], np.cumsum(np.hypot(*np.diff(self.points, axis=0).T)))
        )
        self.length_m = float(self._driven_m[-1])
        changed = np.flatnonzero((np.diff(rows[:, 1:4], axis=0) != 0.0).any(axis=1))
        self.last_motion = int(changed[-1]) + 1 if changed.size else 0

    def evidence(self, index: int, note: str) -> Evidence:
        """A moment of the way."""
        tick = int(self.ticks[index])
        x, y = (round(float(value), 3) for value in self.points[index])
        return Evidence(tick, round(tick * TICK_S, 3), x, y, note)

    def place(self, index: int) -> str:
        """A place of the way, in words."""
        return "({:.2f}, {:.2f})".format(*self.points[index])

    def gap_m(self, index: int) -> float:
        """How far that is from the start."""
        return float(np.hypot(*(self.points[index] - self.points[0])))

    def length_from(self, index: int) -> float:
        """How long the way is after that."""
        return float(self._driven_m[-1] - self._driven_m[index])

    def rests(self, tolerances: Tolerances) -> bool:
        """Whether it stands still at the end."""
        still = self.ticks[-1] - self.ticks[self.last_motion]
        return bool(still * TICK_S >= tolerances["rest_s"])

    def return_to_start(self, tolerances: Tolerances) -> int | None:
        """Where it first was back, after it had been half a side away; None if it never was."""
        gaps = np.hypot(*(self.points - self.points[0]).T)
        away = np.flatnonzero(gaps > tolerances["side_m"] / 2)
        if not away.size:
            return None
        near = gaps <= tolerances["return_m"]
        near[: away[0]] = False
        if not near.any():
            return None
        arrival = int(np.argmax(near))
        gone = np.flatnonzero(~near[arrival:])
        departure = arrival + int(gone[0]) if gone.size else len(gaps)
        return arrival + int(np.argmin(gaps[arrival:departure]))

    def sides(self, tolerances: Tolerances) -> list[Side]:
        """The straight pieces of its first round."""
        lap_end = self.return_to_start(tolerances)
        points = self.points if lap_end is None else self.points[: lap_end + 1]
        marks = simplify(points, tolerances["corner_size_m"])
        found = [side_between(points, a, b) for a, b in pairwise(marks)]
        leads_back = self._leads_back(found, tolerances)
        if leads_back and abs(turn_deg(found[-1], found[0])) < SAME_SIDE_DEG:
            end, begin = found.pop(), found[0]
            worse = max(end, begin, key=lambda side: side.crooked_m)
            found[0] = replace(worse, vector=end.vector + begin.vector, last=begin.last)
        return found

    def corners(self, tolerances: Tolerances) -> list[Corner]:
        """Where its sides meet; the start is one of them if the way leads back to it."""
        found = self.sides(tolerances)
        pairs = list(pairwise(found))
        if self._leads_back(found, tolerances):
            pairs.append((found[-1], found[0]))
        return [Corner(before.last, turn_deg(before, after)) for before, after in pairs]

    def _leads_back(self, found: list[Side], tolerances: Tolerances) -> bool:
        gap = np.hypot(*np.sum([side.vector for side in found], axis=0)) if found else math.inf
        return len(found) > 2 and bool(gap < tolerances["side_m"] / 2)


def side_between(points: FloatArray, first: int, last: int) -> Side:
    """The side between two marks of the way."""
    crooked_at, crooked_m = farthest(points, first, last)
    return Side(points[last] - points[first], last, crooked_m, crooked_at)


def turn_deg(before: Side, after: Side) -> float:
    """By how much the way turns from a side to the next, to the left [deg]."""
    (a, b), (c, d) = before.vector, after.vector
    return math.degrees(math.atan2(a * d - b * c, a * c + b * d))


def simplify(points: FloatArray, error_m: float) -> list[int]:
    """Which points to keep so that all lie within `error_m` of the lines between them.

    The algorithm of Ramer, Douglas and Peucker finds as many as are needed or a few more, and not
    quite in the corners: a side that is parallel to its line of sight is farthest everywhere. So
    each is then looked at again between its neighbours.
    """
    keep = {0, len(points) - 1}
    pending = [(0, len(points) - 1)]
    while pending:
        first, last = pending.pop()
        middle, beside = farthest(points, first, last)
        if beside > error_m:
            keep.add(middle)
            pending += [(first, middle), (middle, last)]
    marks = sorted(keep)
    for _ in range(MOST_LOOKS):
        before = list(marks)
        for mark in before[1:-1]:
            at = marks.index(mark)
            better, beside = farthest(points, marks[at - 1], marks[at + 1])
            marks[at : at + 1] = [better] if beside > error_m else []
        if marks == before:
            break
    return marks


def farthest(points: FloatArray, first: int, last: int) -> tuple[int, float]:
    """The index of the point that is farthest from the line between two, and how far it is [m]."""
    beside = distances(points[first : last + 1], points[first], points[last])
    at = int(np.argmax(beside))
    return first + at, float(beside[at])


def distances(points: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    """How far points are from the line between a and b."""
    along = b - a
    square = float(along @ along)
    share = np.clip((points - a) @ along / square, 0.0, 1.0) if square else np.zeros(len(points))
    result: FloatArray = np.hypot(*(points - a - share[:, None] * along).T)
    return result


def before_first_tick(recording: Recording) -> FloatArray:
    """The row of tick 0: where turtle1 was put, at rest."""
    start = recording.start or Start(SIZE_M / 2, SIZE_M / 2, 0.0)
    pose = np.array((start.x, start.y, start.theta), dtype=np.float32)
    return np.array((0, *pose, 0, 0, 0, 0, 0), dtype=np.float64)
