"""Whether a path is a spiral: where it starts, how it turns, how it grows."""

from __future__ import annotations

import numpy as np

from grader.exercises.turtlesim_challenge.path import Path
from turtlesim_py.world.trajectory import Floats
from turtlesim_py.world.turtle import TICK_S


def turned(path: Path) -> Floats:
    """How far the turtle has turned in each tick of its free way [rad], positive to the left."""
    return path.angular[path.free] * TICK_S


def turns(path: Path) -> tuple[float, float]:
    """Full turns in the main direction, and the share of the turning that went the other way."""
    angles = turned(path)
    total, other = float(np.sum(angles)), 0.0
    way = float(np.sum(np.abs(angles)))
    if way > 0:
        other = float(np.sum(np.abs(angles[angles * np.sign(total) < 0]))) / way
    return abs(total) / (2 * np.pi), other


def growth(path: Path) -> Floats:
    """By how much the mean distance from the centre grows from each full turn to the next [m]."""
    angle = np.abs(np.cumsum(turned(path)))
    turn = np.floor(angle / (2 * np.pi)).astype(int)
    whole = int(turn.max()) if len(turn) else 0
    distance = path.distance[path.free]
    means = [float(distance[turn == k].mean()) for k in range(whole) if (turn == k).any()]
    return np.diff(means) if len(means) > 1 else np.zeros(0)
