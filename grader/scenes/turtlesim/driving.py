"""Drives an arena without ROS: a function takes a submission's place, tick by tick."""

from __future__ import annotations

from collections.abc import Callable

from grader.scenes.scene import Reason, Start
from grader.scenes.turtlesim.recorder import Recorder
from grader.scenes.turtlesim.trace import FIRST_TURTLE, SPRITE, TurtleTrace
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.turtle import Pose

#: (tick, latest pose or None, arena) -> nothing; called before each tick, as callbacks would be.
Controller = Callable[[int, Pose | None, Arena], None]

#: It has come to rest if it stood still for so long: three seconds.
REST_TICKS = 188
#: Nothing has driven yet: fifteen seconds.
FIRST_MOTION_TICKS = 938


def drive(
    controller: Controller, ticks: int, start: Start | None = None
) -> tuple[TurtleTrace, Reason]:
    """Let a controller drive until turtle1 has driven and rested for three seconds, or for `ticks`.

    Who has not driven yet may stand for longer, as in a run of a submission.
    """
    arena = Arena(sprite=SPRITE)
    if start is not None:
        arena.turtles[FIRST_TURTLE].place(start.x, start.y, start.theta)
    recorder = Recorder(arena)
    pose: Pose | None = None
    still, has_driven = 0, False
    for tick in range(1, ticks + 1):
        controller(tick, pose, arena)
        readings = arena.tick()
        recorder.take(readings)
        before, pose = pose, readings[FIRST_TURTLE].pose if FIRST_TURTLE in readings else None
        still = still + 1 if before and pose and before[:3] == pose[:3] else 0
        has_driven = has_driven or bool(before and pose and before[:2] != pose[:2])
        if still >= REST_TICKS and (has_driven or still >= FIRST_MOTION_TICKS):
            break
    return recorder.trace(), "rest" if still >= REST_TICKS else "time_limit"


def twist(arena: Arena, speed: float, turn: float = 1.0) -> None:
    """Publish a velocity command to turtle1: ahead [m/s], to the left [rad/s]."""
    arena.command(FIRST_TURTLE, (speed, 0.0, 0.0), (0.0, 0.0, turn))


def pen(arena: Arena, color: tuple[int, int, int], width: int = 3) -> None:
    """Call turtle1's set_pen: the colour (r, g, b), each 0-255, and the width [px]."""
    arena.set_pen(FIRST_TURTLE, *color, width, 0)
