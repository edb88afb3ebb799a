"""Moves a robot without ROS: a function takes a submission's place, and answers tick by tick."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

from grader.scenes import cdr
from grader.scenes.robot import decoding
from grader.scenes.robot.recorder import Recorder
from grader.scenes.robot.trace import DESCRIPTION, JOINT_STATES, TF, TF_STATIC, TICK_NS, RobotTrace
from robot_py import robot_state
from robot_py.robot_state import Placed, Robot, RobotState

#: When a run begins, on its clock.
EPOCH_NS = 1_750_000_000_000_000_000

#: (tick, time on the clock [ns]) -> what is published in this tick.
Controller = Callable[[int, int], Sequence["Said"]]
#: A topic, and the bytes of a message on it.
Said = tuple[str, bytes]


def drive(controller: Controller, ticks: int, description: str) -> RobotTrace:
    """Let a controller publish for so many ticks, and robot_state_publisher answer."""
    recorder = Recorder()
    state = RobotState(Robot.of(description))

    def send(topic: str, data: bytes) -> None:
        recorder.publishes(topic, data)
        recorder.hears(topic, data)

    send(DESCRIPTION, cdr.string(description))
    send(TF_STATIC, tf(*state.robot.fixed("", EPOCH_NS))[1])
    for tick in range(1, ticks + 1):
        now_ns = EPOCH_NS + tick * TICK_NS
        for topic, data in controller(tick, now_ns):
            if recorder.hears(topic, data) and topic == JOINT_STATES:
                heard = state.hear(_state(data), now_ns).transforms
                if heard is not None:
                    send(TF, tf(*heard)[1])
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


def _state(data: bytes) -> robot_state.JointState:
    said = decoding.joint_states(0, data)
    return robot_state.JointState(said.stamp_ns, said.names, said.positions)


def _header(stamp_ns: int, frame_id: str) -> Any:
    sec, nanosec = divmod(stamp_ns, 1_000_000_000)
    return SimpleNamespace(stamp=SimpleNamespace(sec=sec, nanosec=nanosec), frame_id=frame_id)


def _named(names: str, values: Sequence[float]) -> Any:
    return SimpleNamespace(**dict(zip(names, values, strict=True)))
