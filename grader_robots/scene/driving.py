"""Moves a robot without ROS: a function takes a submission's place, and answers tick by tick.

Among such functions are odd ones, which checks have to survive.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from types import SimpleNamespace
from typing import Any, Final

from grader.recording.subject import Trace
from grader.rosidl import cdr
from grader_robots.scene import decoding
from grader_robots.scene.trace import (
    DESCRIPTION,
    JOINT_STATES,
    TF,
    TF_STATIC,
    TICK_NS,
    RobotRecorder,
    RobotTrace,
)
from robot_py.robot_state import Placed

#: When a run begins, on its clock.
EPOCH_NS = 1_750_000_000_000_000_000

#: (tick, time on the clock [ns]) -> what is published in this tick.
Controller = Callable[[int, int], Sequence["Said"]]
#: A topic, and the bytes of a message on it.
Said = tuple[str, bytes]


def drive(controller: Controller, ticks: int, description: str) -> RobotTrace:
    """Let a controller publish for so many ticks, and robot_state_publisher answer."""
    recorder = RobotRecorder(description)

    def send(topic: str, data: bytes) -> None:
        recorder.publishes(topic, data)
        recorder.hears(topic, data)

    send(DESCRIPTION, cdr.string(description))
    send(*tf(*recorder.fixed(EPOCH_NS), topic=TF_STATIC))
    for tick in range(1, ticks + 1):
        now_ns = EPOCH_NS + tick * TICK_NS
        for topic, data in controller(tick, now_ns):
            if (answer := recorder.answer(topic, data, now_ns)) is not None:
                send(*tf(*answer))
        recorder.ticks += 1
    return recorder.trace()


def joint_state(stamp_ns: int, names: Sequence[str], positions: Sequence[float]) -> Said:
    """A message on /joint_states."""
    message = SimpleNamespace(
        header=_header(stamp_ns, ""), name=names, position=positions, velocity=(), effort=()
    )
    return JOINT_STATES, decoding.joint_state_bytes(message)


def tf(*placed: Placed, topic: str = TF) -> Said:
    """A message on /tf, or another topic."""
    each = [
        SimpleNamespace(
            header=_header(one.stamp_ns, one.frame),
            child_frame_id=one.child_frame,
            transform=SimpleNamespace(
                translation=_named("xyz", one.translation), rotation=_named("xyzw", one.rotation)
            ),
        )
        for one in placed
    ]
    return topic, decoding.tf_bytes(SimpleNamespace(transforms=each))


def _header(stamp_ns: int, frame_id: str) -> Any:
    sec, nanosec = divmod(stamp_ns, 1_000_000_000)
    return SimpleNamespace(stamp=SimpleNamespace(sec=sec, nanosec=nanosec), frame_id=frame_id)


def _named(names: str, values: Sequence[float]) -> Any:
    return SimpleNamespace(**dict(zip(names, values, strict=True)))


# Odd things that a robot's node may publish ------------------------------------------------------

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


def odd_traces(description: str) -> Mapping[str, Trace]:
    """The trace of each beside a robot of a description."""
    return {
        f"a node that {what}": drive(controller, TICKS, description)
        for what, controller in ODDITIES.items()
    }
