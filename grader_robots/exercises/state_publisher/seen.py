"""What every check of the node begins with: the run's trace, its robot, and its moments."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from functools import wraps

import numpy as np

from grader import Evidence, Finding, Recordings, Tolerances
from grader.exercise import error_first, how_it_ended
from grader.scenes.view import Floats
from grader.text import Message, joined, msg
from grader.text import listed as listed_texts
from grader_robots.robot_py.model import Joint
from grader_robots.scene.motion import joints, odometry
from grader_robots.scene.trace import TICK_S, RobotTrace
from grader_robots.scene.view import PLANE


class RobotRun:
    """A run, as the checks look at it.

    Attributes:
        recordings, trace: all that was recorded.
        root: the link in which the robot as a whole moves; '' where nothing was recorded.
        moving: the joints that a joint state moves, by name.
        links: all links.
        joints: what the node said of each joint.
        way: where it said that the root is, in `odom`.
    """

    def __init__(self, recordings: Recordings) -> None:
        self.recordings = recordings
        self.trace = RobotTrace.of(recordings.nominal.trace)
        robot = self.trace.robot
        self.root = robot.model.root if robot else ""
        self.moving: dict[str, Joint] = {} if robot is None else dict(robot.tree.moving)
        self.links = tuple(robot.model.links) if robot else ()
        self.joints = joints(self.trace)
        self.way = odometry(self.trace)
        self.sent = [t for t in self.trace.transforms if t.publisher == "submission"]

    def no_joint_states(self) -> Finding:
        """For a run in which none came."""
        rationale = joined(
            [msg("No joint state came on /joint_states."), how_it_ended(self.recordings.nominal)]
        )
        help = msg(
            "Does your node publish sensor_msgs/msg/JointState there, and does its loop or its "
            "timer get its turn? Who calls rclpy.spin() in a loop never comes back to it."
        )
        return Finding(0, rationale, help)

    def moment(self, tick: int, note: Message) -> Evidence:
        """A tick as evidence, in the place where the robot was then."""
        tick = min(max(int(tick), 1), max(self.trace.ticks, 1))
        x = y = None
        if len(self.way):
            row = max(0, int(np.searchsorted(self.way.ticks, tick, side="right")) - 1)
            found = [float(value) for value in self.way.places[row, :2]]
            if all(map(math.isfinite, found)):
                x, y = (min(max(each, PLANE.origin_m), PLANE.end_m) for each in found)
        return Evidence(round(tick * TICK_S, 3), note, x, y, tick=tick)


def of_run(
    judge: Callable[[RobotRun, Tolerances], Finding],
) -> Callable[[Recordings, Tolerances], Finding]:
    """A check of what the node did; where an error ended the run, that is what to mend first."""

    @wraps(judge)
    def check(recordings: Recordings, tolerances: Tolerances) -> Finding:
        return error_first(recordings, judge(RobotRun(recordings), tolerances))

    return check


def sentence(parts: Sequence[Message]) -> Message:
    """Clauses as a sentence; what begins with the name of a file stays as it is."""
    return msg("{clauses!u}.", clauses=joined(parts, msg("; ")))


def listed(names: Iterable[str]) -> Message:
    """A few names, as they may stand in a sentence."""
    return listed_texts((repr(name[:40]) for name in names), 5) or msg("nothing")


def rounded(value: float) -> float:
    """As it may stand in a sentence, written by `.4g`: -0.506, 0, 29."""
    return round(value, 3) + 0.0


def finite(values: Floats) -> Floats:
    """Those that are numbers, of a size that things have."""
    there: Floats = values[np.abs(values) < 1e6]
    return there
