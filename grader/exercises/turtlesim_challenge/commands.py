"""Finds in a run's velocity commands stops, driving on, and why no circle grows wider."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from grader.exercises.turtlesim_challenge.path import Path
from grader.scenes.turtlesim.trace import stands_still
from grader.text.message import Message, joined, msg
from turtlesim_py.world.events import CmdVel
from turtlesim_py.world.turtle import COMMAND_TIMEOUT_NS, TICK_S

#: Ticks after which a command moves the turtle no more.
WATCHDOG_TICKS = int(COMMAND_TIMEOUT_NS / 1e9 / TICK_S) + 1
#: Two full turns a second: a faster command was meant in degrees [rad/s].
DEGREES = 4 * math.pi
#: Messages of one callback arrive so near together: the simulator reads one message a step.
ONE_MOMENT_TICKS = 2
#: From this part of all commands on, those of linear.x 0 between others are no accident.
ALTERNATING = 0.25
#: With so much from one turn to the next there is no room for two in the window [m].
TOO_WIDE_M = 2.5
#: A faster command comes from a time in nanoseconds that was not divided [m/s].
NANOSECONDS = 1e5


def drove_on(path: Path, until: int, edge_m: float) -> tuple[CmdVel, CmdVel] | None:
    """Find the first command to stop near an edge that one to drive followed, and that one."""
    commands = [call for call in path.calls(CmdVel) if call.tick <= until]
    for stop, further in pairwise(commands):
        if stop.linear[0] or not further.linear[0]:
            continue
        if path.wall_distance[path.row_at(stop.tick)] <= edge_m:
            return stop, further
    return None


def overruled_stop(drove: Sequence[CmdVel]) -> CmdVel | None:
    """Find the command to stop that the last of some commands overruled in the same moment."""
    if len(drove) < 2 or not drove[-1].linear[0]:
        return None
    before, last = drove[-2:]
    in_one = last.tick - before.tick <= ONE_MOMENT_TICKS
    return before if in_one and stands_still(before) else None


def why_no_wider(path: Path) -> Cause | None:
    """Find in the commands why the turtle draws no wider circles; None: it is not known."""
    commands = [call for call in path.calls(CmdVel) if call.tick <= path.stop_tick + 1]
    if len(commands) < 3:
        return None
    return (
        too_fast(path, path.stop_tick)
        or _paused(commands)
        or _degrees(commands)
        or _alternates(commands)
        or _straight(commands)
        or _same(commands)
        or _shrinks(commands)
    )


def why_so_few_turns(path: Path) -> Cause | None:
    """Find in the commands why the turtle makes no two turns before it stops."""
    commands = [call for call in path.calls(CmdVel) if call.tick <= path.stop_tick + 1]
    speeds = np.abs([call.linear[0] for call in commands if call.linear[0]])
    found = too_fast(path, path.stop_tick) or (why_no_wider(path) if len(commands) > 2 else None)
    if found is not None or len(speeds) < 3 or not np.isfinite(speeds).all():
        return found
    step = float(np.median(np.diff(speeds)))
    turns = [call.angular[2] for call in commands if call.linear[0]]
    if step <= 0 or not np.isfinite(turns).all() or not (min(turns) > 0 or max(turns) < 0):
        return None
    gap_s = float(np.median(np.diff([call.tick for call in commands]))) * TICK_S
    turn = float(np.median(np.abs(turns)))
    wider_m = step / max(gap_s, TICK_S) * 2 * math.pi / turn**2
    if wider_m < TOO_WIDE_M:
        return None
    return Cause(
        msg(
            "linear.x grew by {step:.3g} with each command, from {first:.3g} to {last:.3g} m/s.",
            step=step,
            first=speeds[0],
            last=speeds[-1],
        ),
        msg(
            "Let linear.x grow more slowly, or begin smaller: what a command adds decides how "
            "far one turn lies from the next."
        ),
    )


def too_fast(path: Path, until: int) -> Cause | None:
    """Find a command that carries the turtle across the window before the next pose comes."""
    for call in path.calls(CmdVel):
        if call.tick > until + 1:
            break
        speed = abs(call.linear[0])
        if math.isfinite(speed) and speed * TICK_S > path.size_m:
            help_ = msg("linear.x is in metres a second: 1.0 is a good speed.")
            if speed > NANOSECONDS:
                more = msg("Nanoseconds are not seconds: divide by 1e9.")
                help_ = joined([help_, more], " ")
            return Cause(
                msg(
                    "linear.x was {speed} m/s in the command at {time_s:.2f} s: that crosses the "
                    "window before the next pose comes.",
                    speed=f"{call.linear[0]:,.0f}".replace(",", " "),
                    time_s=call.tick * TICK_S,
                ),
                help_,
            )
    return None


def _straight(commands: Sequence[CmdVel]) -> Cause | None:
    """The turtle never turns, perhaps since another part of the Twist was set."""
    if any(call.angular[2] for call in commands):
        return None
    others = [name for at, name in ((0, "x"), (1, "y")) if any(c.angular[at] for c in commands)]
    text = msg("angular.z was 0 in every command.")
    if others:
        text = msg("angular.z was 0 in every command, angular.{axis} was set.", axis=others[0])
    return Cause(text, msg("The turtle turns by angular.z alone: set that, to 1.0 for example."))


def _shrinks(commands: Sequence[CmdVel]) -> Cause | None:
    """linear.x becomes smaller all the time."""
    speeds = np.abs([call.linear[0] for call in commands if call.linear[0]])
    if len(speeds) < 3 or not np.isfinite(speeds).all():
        return None
    if not (np.diff(speeds) <= 0).all() or speeds[-1] > 0.999 * speeds[0]:
        return None
    return Cause(
        msg(
            "linear.x began at {first:.3g} and became smaller, down to {last:.3g}.",
            first=speeds[0],
            last=speeds[-1],
        ),
        msg("Begin small, and let linear.x grow a little with each command."),
    )


def _paused(commands: Sequence[CmdVel]) -> Cause | None:
    gap = float(np.median(np.diff([call.tick for call in commands])))
    if gap <= WATCHDOG_TICKS:
        return None
    return Cause(
        msg(
            "A command came every {gap_s:.2f} s only, and the turtle paused each time: a "
            "command moves it for 1 s.",
            gap_s=gap * TICK_S,
        ),
        msg("Publish faster than once a second."),
    )


def _degrees(commands: Sequence[CmdVel]) -> Cause | None:
    turn = float(np.median([call.angular[2] for call in commands]))
    if not math.isfinite(turn) or abs(turn) <= DEGREES or abs(turn) > 360:
        return None
    return Cause(
        msg(
            "angular.z is {turn:g} rad/s: {turns:.1f} turns a second.",
            turn=turn,
            turns=abs(turn) / (2 * math.pi),
        ),
        msg("angular.z is in radians a second, not in degrees."),
    )


def _alternates(commands: Sequence[CmdVel]) -> Cause | None:
    driving = [bool(call.linear[0]) for call in commands]
    between = sum(
        before and after and not now
        for before, now, after in zip(driving, driving[1:], driving[2:], strict=False)
    )
    if between < ALTERNATING * len(commands):
        return None
    return Cause(
        msg(
            "Commands to drive and commands with linear.x 0 took turns: each overrules the one "
            "before."
        ),
        msg("Publish from one place in your node, linear.x and angular.z in one Twist."),
    )


def _same(commands: Sequence[CmdVel]) -> Cause | None:
    speeds, turns = (
        np.array([v for v in values if v])
        for values in zip(*((c.linear[0], c.angular[2]) for c in commands), strict=True)
    )
    if not len(speeds) or not (np.isfinite(speeds).all() and np.isfinite(turns).all()):
        return None
    if np.ptp(speeds) <= 0.01 * abs(float(speeds.mean())):
        return Cause(
            msg("linear.x was {speed:.3g} in every command.", speed=speeds[0]),
            msg(
                "For a spiral linear.x has to grow a little with each command: does your node "
                "keep the greater value?"
            ),
        )
    if len(turns) != len(speeds):
        return None
    radii = np.abs(speeds / turns)
    if np.ptp(radii) > 0.01 * float(radii.mean()):
        return None
    return Cause(
        msg(
            "angular.z grew with linear.x, from {first:.3g} to {last:.3g}: the radius stays "
            "{radius_m:.2f} m.",
            first=turns[0],
            last=turns[-1],
            radius_m=radii.mean(),
        ),
        msg("Let linear.x grow alone: with a constant angular.z the radius grows."),
    )


@dataclass(frozen=True)
class Cause:
    """The cause of a mistake: a sentence with numbers, and what to do."""

    text: Message
    help: Message
