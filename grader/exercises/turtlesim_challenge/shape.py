"""Measures of a spiral: how a path turns, how it grows, and how it goes round a centre."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from grader.exercise.check import Tolerances
from grader.exercises.turtlesim_challenge.path import CENTRE_M, Path
from turtlesim_py.world.trajectory import Floats
from turtlesim_py.world.turtle import TICK_S

#: A spiral goes round its centre a little less often than the turtle turns: it begins in the
#: centre, where it has gone round nothing when it has turned by half a turn.
BEHIND_TURNS = 0.5
#: The share of a spiral's path that lies outside of its turn before: wobbles are no fault.
MOSTLY = 0.9
#: At how many places, evenly spread over all angles, a path is compared with its turn before.
PLACES = 1000
#: A turtle that heads away from the centre by less than 30 degrees drives outwards, not round.
OUTWARDS = math.cos(math.radians(30.0))
#: The part of a spiral's growth that may come from driving straight outwards.
HALFWAY = 0.5
#: This part of the turns that are asked for shows nothing yet of how they are driven.
TELLING = 0.5


def turned(path: Path) -> Floats:
    """Return the turn in each tick of the free way [rad], positive to the left.

    From -pi to pi: a turtle that turns a thousand times a tick still has one heading only.
    """
    angles = path.angular[path.free] * TICK_S
    angles = np.where(np.isfinite(angles), angles, 0.0)
    wrapped = np.remainder(angles + np.pi, 2 * np.pi) - np.pi
    return np.where(np.abs(angles) > np.pi, wrapped, angles)


def turns(path: Path) -> tuple[float, float]:
    """Return the full turns in the main direction, and the share of turning the other way."""
    angles = turned(path)
    total, other = float(np.sum(angles)), 0.0
    way = float(np.sum(np.abs(angles)))
    if way > 0:
        other = float(np.sum(np.abs(angles[angles * np.sign(total) < 0]))) / way
    return abs(total) / (2 * np.pi), other


def growth(path: Path) -> Floats:
    """Return the growth of the mean distance from the centre, turn by turn [m]."""
    angle = np.abs(np.cumsum(turned(path)))
    turn = np.floor(angle / (2 * np.pi))
    if not len(turn):
        return np.zeros(0)
    is_whole = turn < turn.max()
    _, which, counts = np.unique(turn[is_whole], return_inverse=True, return_counts=True)
    sums = np.bincount(which, weights=path.distance[path.free][is_whole], minlength=len(counts))
    return np.diff(sums / counts)


class Loops(NamedTuple):
    """How a path goes round the centre that it goes round most often.

    Attributes:
        rounds: how often.
        outside: the share of it, from the second round on, that is farther from the centre than
            what was drawn in the same direction one round before; 1 where there is none.
        farthest_m: the most by which it is farther [m].
        straight_out: the share of the growth, from the second round on, that comes from driving
            straight away from the centre instead of round it.
    """

    rounds: float
    outside: float = 1.0
    farthest_m: float = 0.0
    straight_out: float = 0.0


def loops(path: Path) -> Loops:
    """Measure the drawn line alone: how the turtle was heading does not matter.

    The centre is that of the window, the beginning of the path, or its middle.
    """
    points = path.points[path.free]
    if not len(points):
        return Loops(0.0)
    centres = ((CENTRE_M, CENTRE_M), points[0], points.mean(axis=0))
    return max((_round(points - centre) for centre in centres), key=lambda found: found.rounds)


def _round(points: Floats) -> Loops:
    angle = np.unwrap(np.arctan2(points[:, 1], points[:, 0]))
    angle -= angle[0]
    if angle[-1] < 0:
        angle = -angle
    rounds = float(angle[-1]) / (2 * np.pi)
    distance = np.hypot(points[:, 0], points[:, 1])
    # where it turns back for a while, what counts is the line that goes on
    goes_on = angle >= np.maximum.accumulate(angle)
    straight_out = _straight_out(points, distance, angle)
    angle, distance = angle[goes_on], distance[goes_on]
    if angle[-1] <= 2 * np.pi:
        return Loops(rounds)
    wider = distance - np.interp(angle - 2 * np.pi, angle, distance)
    wider = wider[angle >= 2 * np.pi]
    places = np.linspace(2 * np.pi, angle[-1], PLACES)
    outside = np.interp(places, angle[angle >= 2 * np.pi], wider) > 0
    return Loops(rounds, float(outside.mean()), float(wider.max()), straight_out)


def _straight_out(points: Floats, distance: Floats, angle: Floats) -> float:
    """See `Loops.straight_out`; 0 where there is no growth."""
    later = angle[1:] >= 2 * np.pi
    out, way = np.diff(distance)[later], np.hypot(*np.diff(points, axis=0).T)[later]
    total = float(out.sum())
    if total <= 0:
        return 0.0
    return float(out[np.abs(out) >= OUTWARDS * way].sum()) / total


def shown(path: Path, tolerances: Tolerances) -> float:
    """Return how much a path's turns show of how it was driven, 0 to 1.

    1 for all turns that are asked for, 0 for half of them or less, and linear in between: a short
    path can hardly have anything wrong, and shows nothing right.
    """
    turned, _ = turns(path)
    made = min(turned, loops(path).rounds + BEHIND_TURNS) / max(tolerances["turns"], 1e-9)
    return float(np.clip((made - TELLING) / (1 - TELLING), 0.0, 1.0))
