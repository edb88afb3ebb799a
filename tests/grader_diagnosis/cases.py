"""Recordings of runs that never were, for one rule each."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

from grader.exercise.result.diagnosis import Diagnosis
from grader.recording.observations import End, Observations, SourceLine
from grader.recording.recording import PublishedTopic, Recording, Run
from grader.text.message import Message
from tests.grader.driving import Spiral, drive

LINE = SourceLine("drive.py", 39, "on_pose", "self.step(2)")
POSE, TWIST, SET_PEN = "turtlesim/msg/Pose", "geometry_msgs/msg/Twist", "turtlesim/srv/SetPen"
#: What a right controller has.
VELOCITY = End("publisher", "/turtle1/cmd_vel", TWIST, True, 100)
POSES = End("subscription", "/turtle1/pose", POSE, True, 100)
PEN = End("client", "/turtle1/set_pen", SET_PEN, True, 10)


def said(*ends: End, **more: Any) -> Observations:
    """What a program has told: the ends of a right one, if none are given, which it spins."""
    parts: dict[str, Any] = {"ends": ends or (VELOCITY, POSES, PEN), "spun_s": 0.2}
    return Observations(is_known=True, **(parts | more))


def run_of(
    observations: Observations | None = None,
    outcome: Any = "finished",
    *,
    output: str = "",
    topics: tuple[PublishedTopic, ...] = (),
    exit_code: int | None = None,
    flags: tuple[Message, ...] = (),
) -> Recording:
    trace = _trace()
    run = Run("virtual", outcome, exit_code, trace.ticks, trace.duration_ns / 1e9, flags=flags)
    run = replace(run, interfaces="turtlesim", trace_sha256=trace.sha256())
    return Recording(trace, run, topics, output, observations=observations or Observations())


@cache
def _trace() -> Any:
    return drive(Spiral(), ticks=625).trace


def expect_said(found: Diagnosis | None, row: Mapping[str, Any]) -> None:
    """Check that it says some pieces in their order, and by which rule, if the row names one."""
    assert found is not None
    said = f"{found.cause!s} {found.help!s}"
    begin = 0
    for piece in row["says"]:
        assert piece in said[begin:], f"{found.key}: {said}"
        begin = said.index(piece, begin) + len(piece)
    assert found.key == row.get("key", found.key), said
