"""Odd things that a robot's node may publish."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

from grader.recording.recording import Recording
from grader.run import finish
from grader.run.finish import Ending
from grader.run.plan import Plan
from grader.scenes.robot.driving import Controller, Said, drive, joint_state, tf
from grader.scenes.robot.trace import TF_STATIC, TICK_S
from grader.scenes.scene import Limits
from robot_py.robot_state import Placed

#: What the robot of an exercise probably has.
JOINTS = ("swivel", "tilt", "periscope")
UPRIGHT = (0.0, 0.0, 0.0, 1.0)
NAN, INF = math.nan, math.inf


def _nothing(tick: int, now_ns: int) -> Sequence[Said]:
    return ()


def _once(tick: int, now_ns: int) -> Sequence[Said]:
    return _stands(tick, now_ns) if tick == 1 else ()


def _stands(tick: int, now_ns: int) -> Sequence[Said]:
    placed = Placed(now_ns, "odom", "axis", (1.0, 0.0, 0.0), UPRIGHT)
    return joint_state(now_ns, JOINTS, (0.0, 0.0, 0.0)), tf(placed)


def _straight(tick: int, now_ns: int) -> Sequence[Said]:
    return (tf(Placed(now_ns, "odom", "axis", (tick / 100, 0.0, 0.7), UPRIGHT)),)


def _no_numbers(tick: int, now_ns: int) -> Sequence[Said]:
    placed = Placed(now_ns, "odom", "axis", (NAN, INF, -INF), (NAN, 0.0, 0.0, 0.0))
    return joint_state(now_ns, JOINTS, (NAN, INF, -INF)), tf(placed)


def _huge_numbers(tick: int, now_ns: int) -> Sequence[Said]:
    placed = Placed(now_ns, "odom", "axis", (1e308, -1e308, tick * 1e300), (1e200,) * 4)
    return joint_state(now_ns, JOINTS, (1e308, -1e308, tick * 1e300)), tf(placed)


def _zero_quaternion(tick: int, now_ns: int) -> Sequence[Said]:
    placed = Placed(now_ns, "odom", "axis", (math.cos(tick), math.sin(tick), 0.7), (0.0,) * 4)
    return joint_state(now_ns, JOINTS, (tick, tick, tick)), tf(placed)


def _empty(tick: int, now_ns: int) -> Sequence[Said]:
    return joint_state(now_ns, (), ()), tf(), tf(topic=TF_STATIC)


def _other_lengths(tick: int, now_ns: int) -> Sequence[Said]:
    return (joint_state(now_ns, JOINTS, (1.0,)), joint_state(now_ns, (), (1.0, 2.0)))


def _names_twice(tick: int, now_ns: int) -> Sequence[Said]:
    return (joint_state(now_ns, ("tilt", "tilt", ""), (tick / 9, 1.0, 2.0)),)


def _a_circle_of_frames(tick: int, now_ns: int) -> Sequence[Said]:
    frames = (("odom", "axis"), ("axis", "odom"), ("axis", "axis"), ("", "axis"), ("odom", ""))
    return (tf(*(Placed(now_ns, a, b, (0.0, 0.0, 0.0), UPRIGHT) for a, b in frames)),)


def _stamps_before_time(tick: int, now_ns: int) -> Sequence[Said]:
    placed = Placed(-tick * 10**9, "/odom", "/axis", (1.0, 2.0, 3.0), UPRIGHT)
    return joint_state(-tick * 10**9, JOINTS, (1.0, 2.0, 3.0)), tf(placed)


def _at_the_end(tick: int, now_ns: int) -> Sequence[Said]:
    return _stands(tick, now_ns) if tick >= TICKS - 1 else ()


TICKS = 200
#: What the node does -> what it publishes.
ODDITIES: Final[Mapping[str, Controller]] = {
    "does nothing": _nothing,
    "publishes once": _once,
    "stands": _stands,
    "goes straight ahead": _straight,
    "sends what is no number": _no_numbers,
    "sends huge numbers": _huge_numbers,
    "sends a quaternion of zeros": _zero_quaternion,
    "sends empty messages": _empty,
    "sends more names than positions, and less": _other_lengths,
    "names a joint twice": _names_twice,
    "sends frames in a circle": _a_circle_of_frames,
    "stamps before the beginning of time": _stamps_before_time,
    "begins at the very end": _at_the_end,
}


def recorded(controller: Controller, description: str) -> Recording:
    """The recording of a run in which a function publishes in a submission's place."""
    trace = drive(controller, TICKS, description)
    total_s = TICKS * TICK_S
    plan = Plan(Limits(total_s, 0.0, total_s), scene="robot", setting=description)
    ending = Ending(
        time="virtual", outcome="finished", exit_code=None, wall_s=0.0, isolation="", output=""
    )
    return finish.record(plan, trace, (), ending)
