"""How a robot moved: its joints over time, and where the robot as a whole was, as columns."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np
import numpy.typing as npt

from grader.recording import Floats
from grader_robots.scene.decoding import Transform
from grader_robots.scene.trace import TF, RobotTrace

Ints = npt.NDArray[np.int64]

#: The frame in which a robot moves.
ODOM = "odom"


class JointMotion(NamedTuple):
    """What the submission said of one joint.

    Attributes:
        ticks: when, int64 (n,).
        positions: [rad or m], float64 (n,); may be not a number.
    """

    name: str
    ticks: Ints
    positions: Floats


@dataclass(frozen=True, eq=False)
class Odometry:
    """Where the child of one transform was in its parent.

    Attributes:
        ticks: when, int64 (n,).
        places: x, y, z [m], float64 (n, 3).
        quaternions: x, y, z, w, float64 (n, 4).
    """

    ticks: Ints
    places: Floats
    quaternions: Floats

    @classmethod
    def of(cls, transforms: list[Transform]) -> Self:
        return cls(
            np.array([each.tick for each in transforms], dtype=np.int64),
            np.array([each.translation for each in transforms], dtype=np.float64).reshape(-1, 3),
            np.array([each.rotation for each in transforms], dtype=np.float64).reshape(-1, 4),
        )

    def __len__(self) -> int:
        return len(self.ticks)

    @property
    def yaw(self) -> Floats:
        """The heading [rad], of quaternions as they are, whatever their length."""
        x, y, z, w = self.quaternions.T
        with np.errstate(all="ignore"):
            heading: Floats = np.arctan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z)
        return heading


def joints(trace: RobotTrace) -> dict[str, JointMotion]:
    """Every joint that the submission named in a message that can be taken, by name."""
    found: dict[str, list[tuple[int, float]]] = {}
    for state in trace.joint_states:
        if not state.is_taken:
            continue
        named = dict(zip(reversed(state.names), reversed(state.positions), strict=True))
        for name, position in named.items():  # of two of a name the first counts
            found.setdefault(name, []).append((state.tick, position))
    return {name: _joint(name, rows) for name, rows in sorted(found.items())}


def _joint(name: str, rows: list[tuple[int, float]]) -> JointMotion:
    ticks, positions = zip(*rows, strict=True)
    return JointMotion(name, np.array(ticks, dtype=np.int64), np.array(positions, dtype=np.float64))


def odometry(trace: RobotTrace) -> Odometry:
    """Where the robot's root was in `odom`, as the submission sent it on /tf."""
    root = trace.robot.model.root if trace.robot else ""
    sent = (t for t in trace.transforms if (t.topic, t.publisher) == (TF, "submission"))
    return Odometry.of([t for t in sent if (bare(t.parent), bare(t.child)) == (ODOM, root)])


def fitted(points: Floats) -> tuple[float, float, float, float]:
    """The circle nearest to points, by least squares: its centre, radius, and the usual distance.

    Kasa's fit: x² + y² = 2 a x + 2 b y + c. Not a number where the points are none, or a line.
    """
    middle = points.mean(axis=0)
    x, y = (points - middle).T
    matrix = np.column_stack((2 * x, 2 * y, np.ones(len(x))))
    (a, b, c), _, rank, _ = np.linalg.lstsq(matrix, x * x + y * y, rcond=None)
    square = c + a * a + b * b
    if rank < 3 or not square > 0:
        return math.nan, math.nan, math.nan, math.nan
    radius = math.sqrt(square)
    off = float(np.quantile(np.abs(np.hypot(x - a, y - b) - radius), 0.95))
    return float(a + middle[0]), float(b + middle[1]), radius, off


def bare(frame: str) -> str:
    """A frame's name as tf2 takes it: without the slash in front."""
    return frame.removeprefix("/")
