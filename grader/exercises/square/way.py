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
from grader.exercise.driven_path import DrivenPath
from grader.language.phrase import say
from grader.recording.recording import Recording
from grader.scenes.scene import Start
from grader.scenes.turtlesim.trace import TurtleTrace
from turtlesim_py.world.trajectory import Floats
from turtlesim_py.world.turtle import SIZE_M

#: Where a run starts unless it is said otherwise: the middle of the window, heading right.
USUAL_START = Start(SIZE_M / 2, SIZE_M / 2, 0.0)
#: A shorter step is no motion: where it was put and what it publishes differ by rounding [m].
STILL_M = 1e-5
#: Two sides that meet at the start with less of a turn are one side, begun in its middle [deg].
SAME_SIDE_DEG = 30.0
#: How often corners are looked at again; a polygon needs two or three looks.
MOST_LOOKS = 10
#: A way with more corners is no polygon that anybody meant, and is not looked at any closer.
MOST_CORNERS = 300


@dataclass(frozen=True)
class Side:
    """A straight piece of the way; `last` and `crooked_at` are indices of it."""

    vector: Floats
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


class Way(DrivenPath):
    """Where turtle1 drove, from where it drove off until the end of the recording.

    Attributes:
        broken_by: why the way ends before the recording does; "" where it does not.
        moved_away: whether it was put somewhere else before it drove off.
    """

    def __init__(self, recording: Recording, number: int = 0) -> None:
        self.broken_by: str = ""
        whole = DrivenPath(recording, TurtleTrace.of(recording.trace).trajectory(), number)
        if whole.lost is not None:
            self.broken_by = say("its pose was no number any more")
        path = whole.until_lost().begun_at(recording.start or USUAL_START)
        driven = (path.steps_m > STILL_M) & ~path.jumping
        first = int(np.argmax(driven)) - 1 if driven.any() else len(path) - 1
        self.moved_away = bool(path.jumping[: first + 1].any())
        later = np.flatnonzero(path.jumping[first + 1 :])
        end = None
        if later.size:
            end = first + 1 + int(later[0])
            self.broken_by = say("it jumped to another place")
        super().__init__(recording, path.way[first:end], number)

    def rests(self, tolerances: Tolerances) -> bool:
        """Whether it stands still at the end."""
        return bool(self.rested_s >= tolerances["rest_s"])

    @cached_property
    def gap_m(self) -> Floats:
        """How far it is from the start [m], float64 (n,)."""
        return self.distance_from(self.x[0], self.y[0])

    def return_to_start(self, tolerances: Tolerances) -> int | None:
        """Where it first was back, after it had been half a side away; None if it never was."""
        gaps = self.gap_m
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


def side_between(points: Floats, first: int, last: int) -> Side:
    """The side between two marks of the way."""
    crooked_at, crooked_m = farthest(points, first, last)
    return Side(points[last] - points[first], last, crooked_m, crooked_at)


def turn_deg(before: Side, after: Side) -> float:
    """By how much the way turns from a side to the next, to the left [deg]."""
    (a, b), (c, d) = before.vector, after.vector
    return math.degrees(math.atan2(a * d - b * c, a * c + b * d))


def simplify(points: Floats, error_m: float) -> list[int]:
    """Which points to keep so that all lie within `error_m` of the lines between them.

    The algorithm of Ramer, Douglas and Peucker finds as many as are needed or a few more, and not
    quite in the corners: a side that is parallel to its line of sight is farthest everywhere. So
    each is then looked at again between its neighbours.
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
    for _ in range(MOST_LOOKS):
        before = list(marks)
        for mark in before[1:-1]:
            at = marks.index(mark)
            better, beside = farthest(points, marks[at - 1], marks[at + 1])
            marks[at : at + 1] = [better] if beside > error_m else []
        if marks == before:
            break
    return marks


def farthest(points: Floats, first: int, last: int) -> tuple[int, float]:
    """The index of the point that is farthest from the line between two, and how far it is [m]."""
    beside = distances(points[first : last + 1], points[first], points[last])
    at = int(np.argmax(beside))
    return first + at, float(beside[at])


def distances(points: Floats, a: Floats, b: Floats) -> Floats:
    """How far points are from the line between a and b."""
    along = b - a
    square = float(along @ along)
    share = np.clip((points - a) @ along / square, 0.0, 1.0) if square else np.zeros(len(points))
    result: Floats = np.hypot(*(points - a - share[:, None] * along).T)
    return result
