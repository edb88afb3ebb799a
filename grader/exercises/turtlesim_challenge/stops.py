"""How the turtle of one run came to rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from grader.exercise.check import Tolerances
from grader.exercise.sentences import how_it_ended
from grader.exercise.verdict import Evidence, Finding
from grader.exercises.turtlesim_challenge import shape
from grader.exercises.turtlesim_challenge.commands import (
    drove_on,
    overruled_stop,
    stands_still,
    too_fast,
    why_no_wider,
    why_so_few_turns,
)
from grader.exercises.turtlesim_challenge.path import Path
from grader.scenes.turtlesim.driving import REST_TICKS
from turtlesim_py.world.events import CmdVel
from turtlesim_py.world.turtle import TICK_S

#: What is left of the points of a stop near an edge that is not quite one: because no commands
#: came any more, or while the turtle turns on and on.
HALF = 0.5
HALF_OF_IT = " That is half of the points."
#: Who is told to stop so soon after a wall was touched has waited for that.
AT_THE_WALL_TICKS = 32
WALLS = ("left", "bottom", "right", "top")

#: How a run ended. `late`: the time was up while a spiral still grew, and had not
#: touched a wall; `far`: told to stop where no wall is near.
Kind = Literal["stopped", "halfway", "wall", "late", "far", "other", "void"]


@dataclass(frozen=True)
class Stop:
    """The end of one run.

    Attributes:
        finding: what it is worth for itself.
        wall: the wall that it stopped at or ran into; '' for none.
        path: the run's.
    """

    kind: Kind
    finding: Finding
    path: Path
    wall: str = ""


def judge_stop(path: Path, tolerances: Tolerances) -> Stop:
    """Whether a run ended at rest near an edge, by a command, without touching a wall."""
    void = judge_start(path)
    if void is not None:
        return Stop("void", void, path)
    if path.wall is not None:
        wall = nearest_wall(path, path.wall)
        return Stop("wall", _touched(path, wall, tolerances), path, wall)
    if path.lost_tick is not None:
        return Stop("other", _lost(path, path.lost_tick), path)
    if path.last >= len(path) - 2:
        if _is_on_its_way(path, tolerances):
            return Stop("late", _late(path), path)
        return Stop("other", _moving(path, tolerances), path)
    gap = float(path.wall_distance[path.last])
    if gap > tolerances["edge_m"]:
        if _goes_on(path):
            return Stop("other", _moving(path, tolerances), path)
        return _far(path, gap, tolerances)
    finding = _told_to_rest(path, gap)
    kind: Kind = "stopped" if finding.share >= 1 else "halfway" if finding.share else "other"
    return Stop(kind, finding, path, nearest_wall(path, path.last))


def judge_start(path: Path) -> Finding | None:
    """Why a run that starts elsewhere counts for nothing; None: it counts."""
    call = path.moved_away
    if call is None:
        return None
    return Finding(
        0,
        f"This run does not count: at {call.tick * TICK_S:.2f} s your node had the turtle moved "
        f"away from where it was put, by {call.op}.",
        "Begin wherever the turtle is, and read from the pose where that is; reset, teleports, "
        "kill and spawn put it somewhere else.",
        (path.at(call.tick, f"put here by {call.op}"),),
    )


def nearest_wall(path: Path, row: int) -> str:
    """The wall that the turtle is nearest to."""
    return WALLS[int(np.argmin(_to_walls(path)[row]))]


def passed_by_m(stop: Stop) -> float:
    """By how much it had been nearer to its wall before, and drove away again [m]."""
    row = stop.path.last
    to_wall = _to_walls(stop.path)[: row + 1, WALLS.index(stop.wall)]
    return float(to_wall[row] - to_wall.min())


def is_told_to_stop_at(path: Path, tick: int, within_ticks: int) -> bool:
    """Whether a command to stand still came at about this tick."""
    return any(
        stands_still(call) and abs(call.tick - tick) <= within_ticks for call in path.calls(CmdVel)
    )


def _to_walls(path: Path) -> np.ndarray:
    """How far each reading is from each of `WALLS` [m], float64 (n, 4)."""
    return np.column_stack((path.x, path.y, path.size_m - path.x, path.size_m - path.y))


def _touched(path: Path, wall: str, tolerances: Tolerances) -> Finding:
    touched = path.at(int(path.ticks[path.wall or 0]), "it touches the wall here")
    text = f"The turtle ran into the {wall} wall at {touched.time_s:.1f} s"
    fast = too_fast(path, touched.tick)
    if fast is None and shape.turns(path)[0] < 1:
        fast = why_so_few_turns(path)
    if fast is not None:
        return Finding(0, f"{fast.text} {text}.", fast.help, (touched,))
    pair = drove_on(path, touched.tick, tolerances["edge_m"])
    if pair is None and not any(stands_still(call) for call in path.calls(CmdVel)):
        text += ", and no Twist of zeros was ever sent"
        return Finding(0, f"{text}.", _IS_IT_EVER_TRUE, (touched,))
    if pair is None:
        return _too_late(path, text, touched)
    stop, further = pair
    told = path.at(stop.tick, "told to stop here")
    return Finding(0, f"{text}: {_stop_and_go(stop, further)}.", _ONE_SAYS_STOP, (told, touched))


def _too_late(path: Path, text: str, touched: Evidence) -> Finding:
    """It was told to stop, at some time, but not before it was at the wall."""
    told = next(c for c in path.calls(CmdVel) if stands_still(c))
    help_ = "Watch the pose, and stop before a wall is reached."
    if 0 <= told.tick - touched.tick <= AT_THE_WALL_TICKS:
        text = f"{text}, and was told to stop only then"
        help_ = (
            "The limits are too near the walls: x and y never go below 0 or above "
            f"{path.size_m:.2f}. Stop where one of them comes below 1, say, or above 10."
        )
    return Finding(0, f"{text}.", help_, (touched,))


_IS_IT_EVER_TRUE = (
    "Watch the pose, and stop before a wall is reached. If your node does so: is the condition "
    "ever true? `and` or `or`? How far from the walls, at 0 and 11.09, are its limits?"
)
_ONE_SAYS_STOP = (
    "Who stops must also cease to drive: what else in your node publishes velocities, and how does "
    "it learn that the turtle is to stand?"
)


def _stop_and_go(stop: CmdVel, further: CmdVel) -> str:
    return (
        f"your node stopped it at {stop.tick * TICK_S:.2f} s and then sent another command, to "
        f"drive on, at {further.tick * TICK_S:.2f} s"
    )


def _lost(path: Path, tick: int) -> Finding:
    lost = path.at(tick, "the last place it was at")
    return Finding(
        0,
        f"At {lost.time_s:.1f} s your node sent a velocity that is not a number, and the "
        "turtle was nowhere from then on.",
        "Which division or logarithm can give nan or inf?",
        (lost,),
    )


def _is_on_its_way(path: Path, tolerances: Tolerances) -> bool:
    """Whether a spiral grew until the time was up: how near to a wall it stops is not known."""
    if path.recording.run.outcome != "time_limit" or not len(path):
        return False
    if drove_on(path, path.stop_tick, tolerances["edge_m"]) is not None:
        return False
    growth = shape.growth(path)
    return len(growth) > 0 and bool(growth.min() >= tolerances["growth_m"])


def _late(path: Path) -> Finding:
    seconds = f"{path.recording.run.simulated_s:.0f} s"
    end = path.at(path.stop_tick, "here it was when the time was up")
    return Finding(
        0,
        f"A run lasts {seconds}, and then the spiral was still growing, "
        f"{float(path.wall_distance.min()):.2f} m away from the nearest wall: whether the turtle "
        "would have stopped there was not to be seen.",
        "Nothing is wrong with the way so far: let the spiral grow faster, so that it comes near "
        f"a wall within {seconds}.",
        (end,),
    )


def _moving(path: Path, tolerances: Tolerances) -> Finding:
    seconds = f"{path.recording.run.simulated_s:.0f} s"
    end = path.at(path.stop_tick, "the last place it moved to")
    text = f"The turtle was still moving after {seconds}"
    if path.recording.run.outcome == "time_limit":
        text = f"The turtle was still going when the time ({seconds}) was up"
    pair = drove_on(path, path.stop_tick, tolerances["edge_m"])
    if pair is not None:
        stop, further = pair
        told = path.at(stop.tick, "told to stop here")
        return Finding(0, f"{text}: {_stop_and_go(stop, further)}.", _ONE_SAYS_STOP, (told, end))
    nearest = float(path.wall_distance.min()) if len(path) else 0.0
    if nearest > tolerances["edge_m"]:
        text = f"{text}, and never came nearer to a wall than {nearest:.2f} m."
        cause = why_no_wider(path)
        return Finding(
            0,
            text if cause is None else f"{cause.text} {text}",
            "The spiral has to grow until it is near an edge." if cause is None else cause.help,
            (end,),
        )
    return Finding(
        0,
        f"{text}; it had come as near to a wall as {nearest:.2f} m.",
        "Compare x and y of the pose with the size of the window, and publish a zero Twist.",
        (end,),
    )


def _goes_on(path: Path) -> bool:
    """Whether the time was up before a pause was long enough to be a rest."""
    run = path.recording.run
    return run.outcome == "time_limit" and run.ticks - path.stop_tick < REST_TICKS


def _far(path: Path, gap: float, tolerances: Tolerances) -> Stop:
    """It came to rest far from every wall: told so, or carried there by its last command."""
    end = path.at(path.stop_tick, "the last place it moved to")
    rested = (
        f"{gap:.2f} m from the nearest wall; {tolerances['edge_m']:g} m or less is near."
        f"{how_it_ended(path.recording)}"
    )
    unstopped = _unstopped(path)
    if unstopped is None:
        text = f"The turtle came to rest {rested}"
        return Stop(
            "far",
            Finding(0, text, "What should make it stop is the pose, near an edge.", (end,)),
            path,
        )
    text, help_ = unstopped
    return Stop("other", Finding(0, f"{text} It came to rest {rested}", help_, (end,)), path)


def _unstopped(path: Path) -> tuple[str, str] | None:
    """Why no command to stop was in force when it drove no more, with help; None: one was."""
    drove = [call for call in path.calls(CmdVel) if call.tick <= path.stop_tick + 1]
    if drove and not drove[-1].linear[0]:
        return None
    stop = overruled_stop(drove)
    if stop is not None:
        return (
            f"The turtle was told to stop at {stop.tick * TICK_S:.2f} s, and in the same moment to "
            "drive on: the last command counts."
        ), "After the Twist of zeros the same callback publishes once more: is a `return` missing?"
    return (
        "The turtle came to rest because no more commands came, not because it was told to stop."
    ), "Publish a Twist of zeros to stop."


def _told_to_rest(path: Path, gap: float) -> Finding:
    """Whether it was a command that ended all motion, near an edge."""
    end = path.at(path.stop_tick, "the last place it moved to")
    run = path.recording.run
    ending = how_it_ended(path.recording)
    # What counts is the command that was in force when the turtle drove no more, and, where it
    # then turned on the spot, when it turned no more.
    rest_tick = int(path.ticks[path.rest])
    commands = path.calls(CmdVel)
    turned = [call for call in commands if call.tick <= rest_tick + 1]
    unstopped = _unstopped(path)
    if unstopped is not None:
        by_error = run.outcome in ("crashed", "killed", "stalled")
        text, help_ = unstopped
        return Finding(
            0 if by_error else HALF,
            f"{text} It stood {gap:.2f} m from the wall.{ending}"
            + ("" if by_error else HALF_OF_IT),
            help_,
            (end,),
        )
    if path.rest >= len(path) - 2:
        return Finding(
            HALF,
            f"The turtle drove no farther {gap:.2f} m from the wall, but it turned on the spot "
            f"until the run was over.{HALF_OF_IT}",
            "A Twist of zeros stops turning, too: what does angular.z say?",
            (end,),
        )
    if not stands_still(turned[-1]):
        return Finding(
            HALF,
            f"The turtle was told to drive no farther {gap:.2f} m from the wall, and to turn on "
            f"the spot; that ended only because no more commands came.{ending}{HALF_OF_IT}",
            "Publish a Twist of zeros to stop, angular.z as well.",
            (end,),
        )
    return Finding(1, f"stopped by a command, {gap:.2f} m from the wall", evidence=(end,))
