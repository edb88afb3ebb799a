"""Runs that a submission can bring about, odd as they are: checks have to survive all of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final

from grader.exercise.exercise import Exercise
from grader.recording.recording import Recordings
from grader.scenes.turtlesim.driving import Controller, pen, twist
from grader.scenes.turtlesim.trace import FIRST_TURTLE
from grader.testing import robot_oddities
from grader.testing.driving import drive
from grader.testing.odd_packages import odd_packages
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.turtle import Pose

TICKS = 700
#: When the odd thing happens.
WHEN = 300


def _nothing(tick: int, pose: Pose | None, arena: Arena) -> None:
    """It does nothing at all."""


def _round(tick: int, arena: Arena) -> None:
    """Drive round, with a colour, as long as there is a turtle to drive."""
    if FIRST_TURTLE not in arena.turtles:
        return
    if tick % 30 == 1:
        twist(arena, 1.0 + tick / TICKS)
    if tick % 100 == 2:
        pen(arena, (tick % 256, 0, 0))


def _with(odd: Controller) -> Controller:
    """A drive with something odd in the middle of it."""

    def controller(tick: int, pose: Pose | None, arena: Arena) -> None:
        if tick == WHEN:
            odd(tick, pose, arena)
        _round(tick, arena)

    return controller


def _is_killed(tick: int, pose: Pose | None, arena: Arena) -> None:
    arena.kill(FIRST_TURTLE)


def _is_replaced(tick: int, pose: Pose | None, arena: Arena) -> None:
    arena.kill(FIRST_TURTLE)
    arena.spawn(2.0, 2.0, 1.0, FIRST_TURTLE)


def _sends_no_numbers(tick: int, pose: Pose | None, arena: Arena) -> None:
    twist(arena, math.nan, math.inf)


def _sends_no_numbers_only(tick: int, pose: Pose | None, arena: Arena) -> None:
    twist(arena, math.inf, math.nan)


def _killed_at_once(tick: int, pose: Pose | None, arena: Arena) -> None:
    if tick == 1:
        twist(arena, 1.0)
        arena.kill(FIRST_TURTLE)


def _jumps(tick: int, pose: Pose | None, arena: Arena) -> None:
    arena.teleport_absolute(FIRST_TURTLE, 50.0, -50.0, 9.0)


def _starts_anew(tick: int, pose: Pose | None, arena: Arena) -> None:
    arena.reset()


def _wipes(tick: int, pose: Pose | None, arena: Arena) -> None:
    arena.clear()
    arena.set_pen(FIRST_TURTLE, 0, 0, 0, 0, 1)


def _rotates(tick: int, pose: Pose | None, arena: Arena) -> None:
    arena.rotate_absolute(FIRST_TURTLE, -3.0, "goal")


def _adds_another(tick: int, pose: Pose | None, arena: Arena) -> None:
    arena.spawn(3.0, 3.0, 0.0, "turtle2")
    arena.command("turtle2", (2.0, 0.0, 0.0), (0.0, 0.0, 0.0))


def _only_turns(tick: int, pose: Pose | None, arena: Arena) -> None:
    if tick % 30 == 1:
        twist(arena, 0.0, 2.0)


def _into_the_wall(tick: int, pose: Pose | None, arena: Arena) -> None:
    if tick % 30 == 1:
        twist(arena, 4.0, 0.0)


def _one_step(tick: int, pose: Pose | None, arena: Arena) -> None:
    if tick == 1:
        twist(arena, 1.0, 0.0)
    elif tick == 2:
        twist(arena, 0.0, 0.0)


#: What the node does -> what drives.
ODDITIES: Final[Mapping[str, Controller]] = {
    "does nothing": _nothing,
    "makes one step": _one_step,
    "only turns": _only_turns,
    "drives into a wall": _into_the_wall,
    "sends what is no number": _with(_sends_no_numbers),
    "never sends a number": _sends_no_numbers_only,
    "kills its turtle": _with(_is_killed),
    "kills its turtle at once": _killed_at_once,
    "replaces its turtle": _with(_is_replaced),
    "jumps": _with(_jumps),
    "starts anew": _with(_starts_anew),
    "wipes the drawing and lifts the pen": _with(_wipes),
    "rotates to a heading": _with(_rotates),
    "adds another turtle": _with(_adds_another),
}


def odd_recordings(exercise: Exercise) -> Mapping[str, Recordings]:
    """Recordings of every oddity, from every start; none for a scene that has none."""
    if exercise.scene == "robot":
        return {
            f"a node that {what}": Recordings(robot_oddities.recorded(odd, exercise.setting))
            for what, odd in robot_oddities.ODDITIES.items()
        }
    if exercise.scene == "package":
        return odd_packages()
    if exercise.scene != "turtlesim":
        return {}
    return {
        f"a node that {what}": Recordings(
            drive(controller, TICKS),
            tuple(drive(controller, TICKS, start) for start in exercise.starts()),
        )
        for what, controller in ODDITIES.items()
    }
