"""Drives an arena without ROS, by a controller function in place of a submission.

Some controllers are odd, and checks have to survive them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import replace
from typing import Final

from grader.recording.subject import Start, Trace
from grader.scenes.scene import Reason
from grader.scenes.turtlesim.recorder import Recorder, place
from grader.scenes.turtlesim.trace import FIRST_TURTLE, SPRITE, TurtleTrace
from turtlesim_py.scenario import apply
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.turtle import Pose

#: (tick, latest pose or None, arena) -> nothing; called before each tick, as callbacks would be.
Controller = Callable[[int, Pose | None, Arena], None]

#: A run ends after a rest of three seconds.
REST_TICKS = 188
#: Before the first motion, it ends after fifteen seconds.
FIRST_MOTION_TICKS = 938


def drive(
    controller: Controller, ticks: int, start: Start | None = None
) -> tuple[TurtleTrace, Reason]:
    """Let a controller drive until turtle1 has driven and rested for three seconds, or for `ticks`.

    Before it drives, turtle1 may rest for longer, as in a run of a submission.
    """
    arena = Arena(sprite=SPRITE)
    place(arena, start)
    recorder = Recorder(arena)
    pose: Pose | None = None
    still, has_driven = 0, False
    for tick in range(1, ticks + 1):
        controller(tick, pose, arena)
        readings = arena.tick()
        recorder.record(readings)
        before, pose = pose, readings[FIRST_TURTLE].pose if FIRST_TURTLE in readings else None
        still = still + 1 if before and pose and before[:3] == pose[:3] else 0
        has_driven = has_driven or bool(before and pose and before[:2] != pose[:2])
        if still >= REST_TICKS and (has_driven or still >= FIRST_MOTION_TICKS):
            break
    return recorder.trace(), "rest" if still >= REST_TICKS else "time_limit"


def as_commanded(trace: TurtleTrace, start: Start | None) -> TurtleTrace:
    """Return where the same inputs would have taken the turtle if it obeyed them as they are."""
    inputs = trace.by_tick()

    def repeat(tick: int, _: Pose | None, arena: Arena) -> None:
        for event in inputs[tick]:
            with suppress(ValueError):  # refused then, too
                apply(arena, event)

    plain = None if start is None else replace(start, speed=1.0, turn=1.0)
    return drive(repeat, trace.ticks, plain)[0]


def twist(arena: Arena, speed: float, turn: float = 1.0) -> None:
    """Publish a velocity command to turtle1: ahead [m/s], to the left [rad/s]."""
    arena.command(FIRST_TURTLE, (speed, 0.0, 0.0), (0.0, 0.0, turn))


def pen(arena: Arena, color: tuple[int, int, int], width: int = 3) -> None:
    """Call turtle1's set_pen: the colour (r, g, b), each 0-255, and the width [px]."""
    arena.set_pen(FIRST_TURTLE, *color, width, 0)


# Odd controllers ---------------------------------------------------------------------------------

TICKS = 700
#: The tick of the odd action.
WHEN = 300


def _round(tick: int, arena: Arena) -> None:
    """Drive in a circle with changing colours while there is a turtle."""
    if FIRST_TURTLE not in arena.turtles:
        return
    if tick % 30 == 1:
        twist(arena, 1.0 + tick / TICKS)
    if tick % 100 == 2:
        pen(arena, (tick % 256, 0, 0))


def _with(odd: Callable[[Arena], object]) -> Controller:
    """Return a controller that drives, with an odd action in the middle."""

    def controller(tick: int, pose: Pose | None, arena: Arena) -> None:
        if tick == WHEN:
            odd(arena)
        _round(tick, arena)

    return controller


def _again(speed: float, turn: float) -> Controller:
    """Return a controller that sends one command about twice a second."""

    def controller(tick: int, pose: Pose | None, arena: Arena) -> None:
        if tick % 30 == 1:
            twist(arena, speed, turn)

    return controller


def _is_replaced(arena: Arena) -> None:
    arena.kill(FIRST_TURTLE)
    arena.spawn(2.0, 2.0, 1.0, FIRST_TURTLE)


def _killed_at_once(tick: int, pose: Pose | None, arena: Arena) -> None:
    if tick == 1:
        twist(arena, 1.0)
        arena.kill(FIRST_TURTLE)


def _wipes(arena: Arena) -> None:
    arena.clear()
    arena.set_pen(FIRST_TURTLE, 0, 0, 0, 0, 1)


def _adds_another(arena: Arena) -> None:
    arena.spawn(3.0, 3.0, 0.0, "turtle2")
    arena.command("turtle2", (2.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def _one_step(tick: int, pose: Pose | None, arena: Arena) -> None:
    if tick == 1:
        twist(arena, 1.0, 0.0)
    elif tick == 2:
        twist(arena, 0.0, 0.0)


#: What the node does -> its controller.
ODDITIES: Final[Mapping[str, Controller]] = {
    "does nothing": lambda tick, pose, arena: None,
    "makes one step": _one_step,
    "only turns": _again(0.0, 2.0),
    "drives into a wall": _again(4.0, 0.0),
    "sends what is no number": _with(lambda arena: twist(arena, math.nan, math.inf)),
    "never sends a number": lambda tick, pose, arena: twist(arena, math.inf, math.nan),
    "kills its turtle": _with(lambda arena: arena.kill(FIRST_TURTLE)),
    "kills its turtle at once": _killed_at_once,
    "replaces its turtle": _with(_is_replaced),
    "jumps": _with(lambda arena: arena.teleport_absolute(FIRST_TURTLE, 50.0, -50.0, 9.0)),
    "starts anew": _with(Arena.reset),
    "wipes the drawing and lifts the pen": _with(_wipes),
    "rotates to a heading": _with(lambda arena: arena.rotate_absolute(FIRST_TURTLE, -3.0, "goal")),
    "adds another turtle": _with(_adds_another),
}


def odd_traces(start: Start | None) -> Mapping[str, Trace]:
    return {
        f"a node that {what}": drive(controller, TICKS, start)[0]
        for what, controller in ODDITIES.items()
    }
