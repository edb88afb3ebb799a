"""The path that something drove, as arrays, and what exercises ask of it: where, how far, when.

Made for checks: an exercise derives a class of its own that adds the words of its task, or uses
this one as it is. Nothing here raises for what a submission can do: a path may be empty, may have
gaps in its ticks, and may end nowhere.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from grader.exercise.verdict import Evidence
from grader.language.phrase import say
from grader.recording.recording import Recording
from grader.scenes import load_scene
from grader.scenes.scene import Start
from turtlesim_py.world.trajectory import Floats, Trajectory

Mask = npt.NDArray[np.bool_]

#: A step that is longer by this than its speed explains is a jump [m].
JUMP_M = 0.001


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
        scene = load_scene(recording.scene)
        self.recording = recording
        self.number = number
        self.way = way
        self.ticks = way.ticks
        self.x, self.y, self.theta = way.x, way.y, way.theta
        self.linear, self.angular = way.linear, way.angular
        self.tick_s = scene.tick_ns / 1e9
        self.size_m = scene.plane.size_m

    def __len__(self) -> int:
        return len(self.ticks)

    # Parts of it ------------------------------------------------------------------------------

    def part(self, rows: slice | Mask) -> DrivenPath:
        """Some of its readings."""
        return DrivenPath(self.recording, self.way[rows], self.number)

    def begun_at(self, start: Start) -> DrivenPath:
        """The same with one reading more in front: at tick 0 it stood at rest at its start.

        The first reading of a recording lies after the first tick, which may have moved it.
        """
        pose = np.array((start.x, start.y, start.theta), dtype=np.float32)
        row = np.array((0, *pose, 0, 0, 0, 0, 0), dtype=np.float64)
        way = Trajectory.of_rows(np.vstack((row, self.way.rows())))
        return DrivenPath(self.recording, way, self.number)

    def until_lost(self) -> DrivenPath:
        """Up to the first pose that is not a number."""
        return self.part(slice(self.lost))

    def stretches(self, ticks: Iterable[int]) -> list[DrivenPath]:
        """The parts before, between and from these ticks on; some may be empty."""
        cuts = [0, *np.searchsorted(self.ticks, sorted(set(ticks))).tolist(), len(self)]
        return [self.part(slice(first, last)) for first, last in pairwise(cuts)]

    def longest_stretch(self, ticks: Iterable[int]) -> DrivenPath:
        """That of its `stretches` in which it moved in the most ticks."""
        return max(self.stretches(ticks), key=lambda part: int(part.moving.sum()))

    # Motion -----------------------------------------------------------------------------------

    @cached_property
    def lost(self) -> int | None:
        """The row of the first pose that is not a number; None: it was somewhere all the time."""
        nowhere = ~np.isfinite((self.x, self.y, self.theta)).all(axis=0)
        return int(np.argmax(nowhere)) if nowhere.any() else None

    @cached_property
    def steps_m(self) -> Floats:
        """How far it is from the reading before [m], 0 for the first; float64 (n,)."""
        steps = np.zeros(len(self))
        with np.errstate(invalid="ignore"):  # a path that is not cut may hold infinities
            steps[1:] = np.hypot(np.diff(self.x), np.diff(self.y))
        return steps

    @cached_property
    def moving(self) -> Mask:
        """Whether the position differs from the reading before."""
        return _changes(self.x) | _changes(self.y)

    @cached_property
    def jumping(self) -> Mask:
        """Whether the way from the reading before is longer than its speed explains."""
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
        """How long the way to each reading is [m], float64 (n,)."""
        return np.cumsum(self.steps_m)

    @property
    def length_m(self) -> float:
        """How long all of it is [m]."""
        return float(self.driven_m[-1]) if len(self) else 0.0

    def length_from(self, row: int) -> float:
        """How long the way is from there to the end [m]."""
        return float(self.driven_m[-1] - self.driven_m[row])

    # Places -----------------------------------------------------------------------------------

    @cached_property
    def points(self) -> Floats:
        """Where it was [m], float64 (n, 2)."""
        return np.column_stack((self.x, self.y))

    def distance_from(self, x: float, y: float) -> Floats:
        """How far each reading is from a place [m], float64 (n,)."""
        return np.hypot(self.x - x, self.y - y)

    @cached_property
    def wall_distance(self) -> Floats:
        """To the nearest wall [m], float64 (n,)."""
        sides = [self.x, self.y, self.size_m - self.x, self.size_m - self.y]
        return np.asarray(np.minimum.reduce(sides))

    @cached_property
    def wall(self) -> int | None:
        """The first row at which a wall stopped it; None: none did."""
        clamped = (self.x <= 0) | (self.y <= 0) | (self.x >= self.size_m) | (self.y >= self.size_m)
        return int(np.argmax(clamped)) if clamped.any() else None

    def place(self, row: int) -> str:
        """Where it was, in words."""
        return say("({x:.2f}, {y:.2f})", x=self.x[row], y=self.y[row])

    def evidence(self, row: int, note: str) -> Evidence:
        """What a finding can point at: its place and time at a row. -1 is the last."""
        tick = int(self.ticks[row])
        x, y = round(float(self.x[row]), 3), round(float(self.y[row]), 3)
        return Evidence(tick, round(tick * self.tick_s, 3), x, y, note, self.number)

    def at(self, tick: int, note: str) -> Evidence:
        """The same for the first reading at or after a tick, or the last one.

        Where there is no reading at all, it points to the middle of the arena.
        """
        if not len(self):
            middle = self.size_m / 2.0
            time_s = round(tick * self.tick_s, 3)
            return Evidence(tick, time_s, middle, middle, note, self.number)
        row = int(np.clip(np.searchsorted(self.ticks, tick), 0, len(self) - 1))
        return self.evidence(row, note)


def _changes(values: Floats) -> Mask:
    """Where a value differs from the one before."""
    changed = np.zeros(len(values), dtype=bool)
    changed[1:] = values[1:] != values[:-1]
    return changed


def _last(mask: Mask) -> int:
    """The last row where it is true, 0 without any."""
    return int(len(mask) - 1 - np.argmax(mask[::-1])) if mask.any() else 0
