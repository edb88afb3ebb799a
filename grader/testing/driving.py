"""Recordings made without ROS, in milliseconds: a function drives the real world."""

from __future__ import annotations

from grader.recording.recording import Recording
from grader.run import finish
from grader.run.finish import Ending
from grader.run.plan import Plan
from grader.scenes.scene import Limits, Start
from grader.scenes.turtlesim import driving
from grader.scenes.turtlesim.driving import Controller
from turtlesim_py.world.turtle import TICK_S


def drive(
    controller: Controller, ticks: int = 4000, start: Start | None = None, output: str = ""
) -> Recording:
    """The recording of a run in which a function drives turtle1 in a submission's place.

    It ends when turtle1 has rested for three seconds, or after so many ticks.

    Args:
        controller: called before each tick with its number, the latest pose (None before the
            first) and the arena, in which it may do whatever a submission's callbacks could.
        start: where turtle1 begins; None for the centre of the window.
        output: what the submission is said to have printed.
    """
    trace, reason = driving.drive(controller, ticks, start)
    rest_s = driving.REST_TICKS * TICK_S
    plan = Plan(Limits(first_motion_s=rest_s, rest_s=rest_s, total_s=ticks * TICK_S), start)
    ending = Ending(
        time="virtual",
        outcome=finish.outcome(reason, None),
        exit_code=None,
        wall_s=0.0,
        isolation="",
        output=output,
    )
    return finish.record(plan, trace, (), ending)
