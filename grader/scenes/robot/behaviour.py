"""What a submission had a robot do; equal for two that did the same."""

from __future__ import annotations

from typing import Any

import numpy as np

from grader.scenes.robot.motion import odometry
from grader.scenes.robot.trace import RobotTrace
from grader.scenes.scene import Behaviour, Command


def behaviour(trace: RobotTrace) -> Behaviour:
    """Every joint state, and the robot's way up to where it was nowhere."""
    commands = (Command(s.tick, "joint_states", s.positions) for s in trace.joint_states)
    points = odometry(trace).places[:, :2]
    lost = np.flatnonzero(~np.isfinite(points).all(axis=1))
    return Behaviour(tuple(commands), points[: int(lost[0])] if len(lost) else points)


def scenario(trace: RobotTrace) -> dict[str, Any]:
    """The joint states that were heard: what is not a number is None."""
    return {
        "ticks": trace.ticks,
        "joint_states": [
            {
                "tick": state.tick,
                "stamp_ns": state.stamp_ns,
                "name": list(state.names),
                "position": [p if np.isfinite(p) else None for p in state.positions],
            }
            for state in trace.joint_states
            if 1 <= state.tick <= trace.ticks
        ],
    }
