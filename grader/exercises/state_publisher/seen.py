"""What every check begins with: the run's trace, its robot, and moments to point to."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from grader.exercise.sentences import how_it_ended
from grader.exercise.verdict import Evidence, Finding
from grader.language.phrase import joined, say
from grader.recording.recording import Recordings
from grader.scenes.robot.motion import Floats, joints, odometry
from grader.scenes.robot.trace import TF, TF_STATIC, TICK_S, RobotTrace
from grader.scenes.robot.view import PLANE
from robot_py.model import Joint as UrdfJoint


class Seen:
    """A run, as the checks look at it.

    Attributes:
        trace: all that was recorded.
        root: the link in which the robot as a whole moves; '' where nothing was recorded.
        moving: the joints that a joint state moves, by name.
        links: all links.
        joints: what the node said of each joint.
        way: where it said that the root is, in `odom`.
    """

    def __init__(self, recordings: Recordings) -> None:
        self.recording = recordings.nominal
        self.trace = RobotTrace.of(self.recording.trace)
        robot = self.trace.robot
        self.root = robot.model.root if robot else ""
        self.moving: dict[str, UrdfJoint] = {} if robot is None else dict(robot.tree.moving)
        self.links = tuple(robot.model.links) if robot else ()
        self.joints = joints(self.trace)
        self.way = odometry(self.trace)
        self.sent = [
            t
            for t in self.trace.transforms
            if t.publisher == "submission" and t.topic in (TF, TF_STATIC)
        ]

    def no_joint_states(self) -> Finding:
        """For a run in which none came."""
        return Finding(
            0,
            say("No joint state came on /joint_states.") + how_it_ended(self.recording),
            say(
                "Does your node publish sensor_msgs/msg/JointState there, and does its "
                "loop or its timer get its turn? Who calls rclpy.spin() in a loop never"
                " comes back to it."
            ),
        )

    def moment(self, tick: int, note: str) -> Evidence:
        """A tick as evidence, in the place where the robot was then."""
        tick = min(max(int(tick), 1), max(self.trace.ticks, 1))
        x = y = 0.0
        if len(self.way):
            row = max(0, int(np.searchsorted(self.way.ticks, tick, side="right")) - 1)
            x, y = (float(value) for value in self.way.places[row, :2])
        return Evidence(tick, round(tick * TICK_S, 3), _inside(x), _inside(y), note)


def sentence(parts: Sequence[str]) -> str:
    """Clauses as a sentence; what begins with the name of a file stays as it is."""
    return say("{clauses!u}.", clauses=joined(parts, say("; ")))


def rounded(value: float) -> float:
    """As it may stand in a sentence, written by `.4g`: -0.506, 0, 29."""
    return round(value, 3) + 0.0


def _inside(value: float) -> float:
    if not math.isfinite(value):
        return 0.0
    return min(max(value, PLANE.origin_m), PLANE.end_m)


def finite(values: Floats) -> Floats:
    """Those that are numbers, of a size that things have."""
    there: Floats = values[np.abs(values) < 1e6]
    return there
