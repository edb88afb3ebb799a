"""What is looked at."""

from __future__ import annotations

from grader.exercise.check import Checks, Tolerances
from grader.exercise.verdict import Finding
from grader.recording.recording import Recordings
from grader.scenes.robot.trace import RobotTrace

checks = Checks()


@checks()
def publishes(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """It publishes joint states steadily."""
    trace = RobotTrace.of(recordings.nominal.trace)
    count = len(trace.joint_states)
    return Finding(
        1 if count > 10 else 0, f"{count} joint states, {len(trace.transforms)} transforms", "x"
    )
