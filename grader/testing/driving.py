"""Recordings without a robot: a function drives turtle1 as a submission would."""

from __future__ import annotations

from collections.abc import Callable

from grader.recording.recording import Recording, Run
from grader.recording.subject import Start
from grader.run import finish
from grader.run.handover import Plan
from grader.scenes.scene import Limits
from grader.scenes.turtlesim import driving
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.turtle import TICK_S, Pose

#: Returns the velocity to publish to turtle1, ahead [m/s] and to the left [rad/s]; None for none.
Controller = Callable[[int, Pose | None, Arena], tuple[float, float] | None]


def drive(
    controller: Controller, ticks: int = 4000, start: Start | None = None, output: str = ""
) -> Recording:
    """Return the recording of a run in which a function drives turtle1 as a submission would.

    Made without ROS, in milliseconds: the world is the real one.

    The run ends when turtle1 has rested for three seconds, or after `ticks`.

    Args:
        controller: called before each tick with its number, the latest pose (None before the
            first) and the arena, in which it may do anything that a submission's callbacks could.
            It may return a velocity command to publish: ahead [m/s], to the left [rad/s].
        start: where turtle1 begins; None for the centre of the window.
        output: the recorded output of the submission.
    """

    def control(tick: int, pose: Pose | None, arena: Arena) -> None:
        velocity = controller(tick, pose, arena)
        if isinstance(velocity, tuple):  # a lambda may return anything else
            driving.twist(arena, *velocity)

    trace, reason = driving.drive(control, ticks, start)
    rest_s = driving.REST_TICKS * TICK_S
    plan = Plan(Limits(first_motion_s=rest_s, rest_s=rest_s, total_s=ticks * TICK_S), start)
    run = Run("virtual", finish.outcome(reason, None))
    return finish.record(plan, trace, (), finish.Ending(run, output))
