"""Moves a robot without a node: a function takes a submission's place, and answers tick by tick.

Among such functions are odd ones, which checks have to survive.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Final

from grader.recording import Trace, serialise, string
from grader_robots.robot_py.model import Vector
from grader_robots.robot_py.robot_state import Placed
from grader_robots.scene.trace import (
    DESCRIPTION,
    JOINT_STATES,
    TF,
    TF_STATIC,
    TICK_NS,
    RobotRecorder,
    RobotTrace,
)

#: When a run begins, on its clock.
EPOCH_NS = 1_750_000_000_000_000_000

#: (tick, time on the clock [ns]) -> what is published in this tick.
Controller = Callable[[int, int], Sequence["Said"]]
#: A topic, and the bytes of a message on it.
Said = tuple[str, bytes]
Quaternion = tuple[float, float, float, float]


def drive(controller: Controller, ticks: int, description: str) -> RobotTrace:
    """Let a controller publish for so many ticks, and robot_state_publisher answer."""
    recorder = RobotRecorder(description)

    def send(topic: str, data: bytes) -> None:
        recorder.publishes(topic, data)
        recorder.hears(topic, data)

    send(DESCRIPTION, string(description))
    send(*tf(*recorder.fixed(EPOCH_NS), topic=TF_STATIC))
    for tick in range(1, ticks + 1):
        now_ns = EPOCH_NS + tick * TICK_NS
        for topic, data in controller(tick, now_ns):
            if (answer := recorder.answer(topic, data, now_ns)) is not None:
                send(*tf(*answer))
        recorder.ticks += 1
    return recorder.trace()


def joint_state(stamp_ns: int, names: Sequence[str], positions: Sequence[float]) -> Said:
    from sensor_msgs.msg import JointState

    message = JointState(name=names, position=positions)
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp_ns, 10**9)
    return JOINT_STATES, serialise(message)


def tf(*placed: Placed, topic: str = TF) -> Said:
    """A message on /tf, or another topic."""
    from grader_robots.robot_py.robot_state_publisher import tf_message

    return topic, serialise(tf_message(placed))


# Odd things that a robot's node may publish ------------------------------------------------------

#: What the robot of an exercise probably has.
JOINTS = ("swivel", "tilt", "periscope")
UPRIGHT = (0.0, 0.0, 0.0, 1.0)
NAN, INF = math.nan, math.inf
TICKS = 200


def _sends(
    now_ns: int, positions: Sequence[float], place: Vector, turned: Quaternion = UPRIGHT
) -> Sequence[Said]:
    return joint_state(now_ns, JOINTS, positions), _goes(now_ns, place, turned)


def _goes(now_ns: int, place: Vector, turned: Quaternion = UPRIGHT) -> Said:
    return tf(Placed(now_ns, "odom", "axis", place, turned))


def _stands(now_ns: int) -> Sequence[Said]:
    return _sends(now_ns, (0.0, 0.0, 0.0), (1.0, 0.0, 0.0))


def _a_circle_of_frames(tick: int, now_ns: int) -> Sequence[Said]:
    frames = (("odom", "axis"), ("axis", "odom"), ("axis", "axis"), ("", "axis"), ("odom", ""))
    return (tf(*(Placed(now_ns, a, b, (0.0, 0.0, 0.0), UPRIGHT) for a, b in frames)),)


def _stamps_before_time(tick: int, now_ns: int) -> Sequence[Said]:
    placed = Placed(-tick * 10**9, "/odom", "/axis", (1.0, 2.0, 3.0), UPRIGHT)
    return joint_state(-tick * 10**9, JOINTS, (1.0, 2.0, 3.0)), tf(placed)


#: What the node does -> what it publishes.
ODDITIES: Final[Mapping[str, Controller]] = {
    "does nothing": lambda tick, now_ns: (),
    "publishes once": lambda tick, now_ns: _stands(now_ns) if tick == 1 else (),
    "stands": lambda tick, now_ns: _stands(now_ns),
    "goes straight ahead": lambda tick, now_ns: (_goes(now_ns, (tick / 100, 0.0, 0.7)),),
    "sends what is no number": lambda tick, now_ns: _sends(
        now_ns, (NAN, INF, -INF), (NAN, INF, -INF), (NAN, 0.0, 0.0, 0.0)
    ),
    "sends huge numbers": lambda tick, now_ns: _sends(
        now_ns, (1e308, -1e308, tick * 1e300), (1e308, -1e308, tick * 1e300), (1e200,) * 4
    ),
    "sends a quaternion of zeros": lambda tick, now_ns: _sends(
        now_ns, (tick, tick, tick), (math.cos(tick), math.sin(tick), 0.7), (0.0,) * 4
    ),
    "sends empty messages": lambda tick, now_ns: (
        joint_state(now_ns, (), ()),
        tf(),
        tf(topic=TF_STATIC),
    ),
    "sends more names than positions, and less": lambda tick, now_ns: (
        joint_state(now_ns, JOINTS, (1.0,)),
        joint_state(now_ns, (), (1.0, 2.0)),
    ),
    "names a joint twice": lambda tick, now_ns: (
        joint_state(now_ns, ("tilt", "tilt", ""), (tick / 9, 1.0, 2.0)),
    ),
    "sends frames in a circle": _a_circle_of_frames,
    "stamps before the beginning of time": _stamps_before_time,
    "begins at the very end": lambda tick, now_ns: _stands(now_ns) if tick >= TICKS - 1 else (),
}


def odd_traces(description: str) -> Mapping[str, Trace]:
    """The trace of each beside a robot of a description."""
    return {
        f"a node that {what}": drive(controller, TICKS, description)
        for what, controller in ODDITIES.items()
    }
