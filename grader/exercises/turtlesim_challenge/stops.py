"""Judges how the turtle of one run came to rest."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from grader.exercise.check import Tolerances
from grader.exercise.sentences import how_it_ended
from grader.exercise.verdict import Evidence, Finding
from grader.exercises.turtlesim_challenge import shape
from grader.exercises.turtlesim_challenge.commands import (
    drove_on,
    overruled_stop,
    too_fast,
    why_no_wider,
    why_so_few_turns,
)
from grader.exercises.turtlesim_challenge.path import Path
from grader.scenes.turtlesim.driving import REST_TICKS
from grader.scenes.turtlesim.trace import stands_still
from grader.text.message import NOTHING, Message, in_context, joined, msg
from turtlesim_py.world.events import CmdVel
from turtlesim_py.world.turtle import TICK_S

#: The share of points for a stop near an edge that is none by a command: because no commands came
#: any more, or while the turtle turns on and on.
HALF = 0.5
HALF_OF_IT = msg("That is half of the points.")
#: A stop command so soon after a wall was touched was sent because of that.
AT_THE_WALL_TICKS = 32
WALLS = ("left", "bottom", "right", "top")
#: How sentences name them: "the {wall} wall". The keys tell translators which left is meant.
WALL_NAMES = {
    "left": in_context("left", "of a wall"),
    "bottom": in_context("bottom", "of a wall"),
    "right": in_context("right", "of a wall"),
    "top": in_context("top", "of a wall"),
}

#: How a run ended. `late`: the time was up while a spiral still grew, and had not
#: touched a wall; `far`: a stop by a command where no wall is near.
Kind = Literal["stopped", "halfway", "wall", "late", "far", "other"]


@dataclass(frozen=True)
class Stop:
    """The end of one run.

    Attributes:
        finding: what it is worth for itself.
        wall: the wall that it stopped at or ran into; '' for none.
        path: the run's.
        seen: the finding's rationale without what that is worth.
    """

    kind: Kind
    finding: Finding
    path: Path
    wall: str = ""
    seen: Message = NOTHING

    @property
    def gap_m(self) -> float:
        """The distance from the nearest wall at its last motion [m]."""
        return float(self.path.wall_distance[self.path.last])


def judge_stop(path: Path, tolerances: Tolerances) -> Stop:
    """Judge whether a run ended at rest near an edge, by a command, without touching a wall."""
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
    finding = _rest_by_command(path, gap)
    kind: Kind = "stopped" if finding.share >= 1 else "halfway" if finding.share else "other"
    seen = finding.rationale
    if kind == "halfway":
        finding = replace(finding, rationale=joined([seen, HALF_OF_IT], " "))
    return Stop(kind, finding, path, nearest_wall(path, path.last), seen)


def nearest_wall(path: Path, row: int) -> str:
    """Return the wall that the turtle is nearest to."""
    return WALLS[int(np.argmin(path.to_walls[row]))]


def has_stop_command_at(path: Path, tick: int, within_ticks: int) -> bool:
    """Whether a command to stop came at about this tick."""
    return any(
        stands_still(call) and abs(call.tick - tick) <= within_ticks for call in path.calls(CmdVel)
    )


def _touched(path: Path, wall: str, tolerances: Tolerances) -> Finding:
    at = int(path.ticks[path.wall or 0])
    touched = path.at(at, msg("it touches the wall here"))
    ran = {"wall": WALL_NAMES[wall], "time_s": touched.time_s}
    fast = too_fast(path, at)
    if fast is None and shape.turns(path)[0] < 1:
        fast = why_so_few_turns(path)
    if fast is not None:
        text = msg("The turtle ran into the {wall} wall at {time_s:.1f} s.", **ran)
        return Finding(0, joined([fast.text, text], " "), fast.help, (touched,))
    pair = drove_on(path, at, tolerances["edge_m"])
    if pair is None and not any(stands_still(call) for call in path.calls(CmdVel)):
        text = msg(
            "The turtle ran into the {wall} wall at {time_s:.1f} s, and no Twist of zeros was "
            "ever sent.",
            **ran,
        )
        return Finding(0, text, _IS_IT_EVER_TRUE, (touched,))
    if pair is None:
        return _too_late(path, ran, touched, at)
    stop, further = pair
    stopped = path.at(stop.tick, _STOP_NOTE)
    text = msg(
        "The turtle ran into the {wall} wall at {time_s:.1f} s: {what_came}.",
        what_came=_stop_and_go(stop, further),
        **ran,
    )
    return Finding(0, text, _ONE_SAYS_STOP, (stopped, touched))


def _too_late(path: Path, ran: Mapping[str, Any], touched: Evidence, at: int) -> Finding:
    """Judge a run whose first stop command came only at the wall."""
    stopped = next(c for c in path.calls(CmdVel) if stands_still(c))
    if not 0 <= stopped.tick - at <= AT_THE_WALL_TICKS:
        text = msg("The turtle ran into the {wall} wall at {time_s:.1f} s.", **ran)
        help_ = msg("Watch the pose, and stop before a wall is reached.")
        return Finding(0, text, help_, (touched,))
    return Finding(
        0,
        msg(
            "The turtle ran into the {wall} wall at {time_s:.1f} s, and was told to stop only "
            "then.",
            **ran,
        ),
        msg(
            "The limits are too near the walls: x and y never go below 0 or above {size}. Stop "
            "where one of them comes below 1, say, or above 10.",
            size=f"{path.size_m:.2f}",
        ),
        (touched,),
    )


_STOP_NOTE = msg("told to stop here")
_LAST_PLACE = msg("the last place it moved to")
_IS_IT_EVER_TRUE = msg(
    "Watch the pose, and stop before a wall is reached. If your node does so: is the condition "
    "ever true? `and` or `or`? How far from the walls, at 0 and 11.09, are its limits?"
)
_ONE_SAYS_STOP = msg(
    "After stopping, don't send driving commands. What else in your node publishes velocities, "
    "and how does it learn that the turtle has to stand still?"
)


def _stop_and_go(stop: CmdVel, further: CmdVel) -> Message:
    return msg(
        "your node stopped it at {stop_s:.2f} s and then sent another command, to drive on, at "
        "{further_s:.2f} s",
        stop_s=stop.tick * TICK_S,
        further_s=further.tick * TICK_S,
    )


def _lost(path: Path, tick: int) -> Finding:
    lost = path.at(tick, msg("the last place it was at"))
    return Finding(
        0,
        msg(
            "At {time_s:.1f} s your node sent a velocity that is not a number, and the "
            "turtle was nowhere from then on.",
            time_s=lost.time_s,
        ),
        msg("Which division or logarithm can give nan or inf?"),
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
    seconds = path.recording.run.simulated_s
    end = path.at(path.stop_tick, msg("here it was when the time was up"))
    return Finding(
        0,
        msg(
            "A run lasts {seconds:.0f} s, and then the spiral was still growing, {away_m:.2f} m "
            "away from the nearest wall: whether the turtle would have stopped there could not "
            "be seen.",
            seconds=seconds,
            away_m=path.wall_distance.min(),
        ),
        msg(
            "The path is right so far: let the spiral grow faster, so that it comes near a wall "
            "within {seconds:.0f} s.",
            seconds=seconds,
        ),
        (end,),
    )


def _moving(path: Path, tolerances: Tolerances) -> Finding:
    end = path.at(path.stop_tick, _LAST_PLACE)
    text = _was_still_moving(path)
    pair = drove_on(path, path.stop_tick, tolerances["edge_m"])
    if pair is not None:
        stop, further = pair
        stopped = path.at(stop.tick, _STOP_NOTE)
        text = msg("{moving}: {what_came}.", moving=text, what_came=_stop_and_go(stop, further))
        return Finding(0, text, _ONE_SAYS_STOP, (stopped, end))
    nearest = float(path.wall_distance.min()) if len(path) else 0.0
    if nearest <= tolerances["edge_m"]:
        text = msg(
            "{moving}; it had come as near to a wall as {nearest_m:.2f} m.",
            moving=text,
            nearest_m=nearest,
        )
        help_ = msg(
            "Compare x and y of the pose with the size of the window, and publish a zero Twist."
        )
    else:
        text = msg(
            "{moving}, and never came nearer to a wall than {nearest_m:.2f} m.",
            moving=text,
            nearest_m=nearest,
        )
        help_ = msg("The spiral has to grow until it is near an edge.")
    if (cause := why_no_wider(path)) is not None:
        text, help_ = joined([cause.text, text], " "), cause.help
    return Finding(0, text, help_, (end,))


def _was_still_moving(path: Path) -> Message:
    run = path.recording.run
    if run.outcome == "time_limit":
        return msg(
            "The turtle was still going when the time ({seconds:.0f} s) was up",
            seconds=run.simulated_s,
        )
    return msg("The turtle was still moving after {seconds:.0f} s", seconds=run.simulated_s)


def _goes_on(path: Path) -> bool:
    """Whether the time was up before a pause was long enough to be a rest."""
    run = path.recording.run
    return run.outcome == "time_limit" and run.ticks - path.stop_tick < REST_TICKS


def _far(path: Path, gap: float, tolerances: Tolerances) -> Stop:
    """Judge a rest far from every wall: by a command, or where its last command led."""
    end = path.at(path.stop_tick, _LAST_PLACE)
    ending = how_it_ended(path.recording)
    rested = {"gap_m": gap, "near_m": tolerances["edge_m"]}
    unstopped = _unstopped(path)
    if unstopped is None:
        text = msg(
            "The turtle came to rest {gap_m:.2f} m from the nearest wall; {near_m:g} m or less is "
            "near.",
            **rested,
        )
        help_ = msg("What should make it stop is the pose, near an edge.")
        return Stop("far", Finding(0, joined([text, ending]), help_, (end,)), path)
    why, help_ = unstopped
    text = msg(
        "It came to rest {gap_m:.2f} m from the nearest wall; {near_m:g} m or less is near.",
        **rested,
    )
    return Stop("other", Finding(0, joined([why, " ", text, ending]), help_, (end,)), path)


def _unstopped(path: Path) -> tuple[Message, Message] | None:
    """Say why no stop command was in force when it drove no more, with help; None: one was."""
    drove = [call for call in path.calls(CmdVel) if call.tick <= path.stop_tick + 1]
    if drove and not drove[-1].linear[0]:
        return None
    stop = overruled_stop(drove)
    if stop is not None:
        return msg(
            "The turtle was told to stop at {time_s:.2f} s, and in the same moment to "
            "drive on: the last command counts.",
            time_s=stop.tick * TICK_S,
        ), msg(
            "After the Twist of zeros the same callback publishes once more: is a `return` missing?"
        )
    return msg(
        "The turtle came to rest because no more commands came, not because it was told to stop."
    ), msg("Publish a Twist of zeros to stop.")


def _rest_by_command(path: Path, gap: float) -> Finding:
    """Judge whether it was a command that ended all motion, near an edge."""
    end = path.at(path.stop_tick, _LAST_PLACE)
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
        why, help_ = unstopped
        stood = msg("It stood {gap_m:.2f} m from the wall.", gap_m=gap)
        text = joined([why, " ", stood, ending])
        return Finding(0 if by_error else HALF, text, help_, (end,))
    if path.rest >= len(path) - 2:
        text = msg(
            "The turtle stopped driving {gap_m:.2f} m from the wall, but it turned on the spot "
            "until the run was over.",
            gap_m=gap,
        )
        help_ = msg("A Twist of zeros stops turning, too: what does angular.z say?")
        return Finding(HALF, text, help_, (end,))
    if not stands_still(turned[-1]):
        text = msg(
            "Your node stopped driving {gap_m:.2f} m from the wall, but let the turtle turn on "
            "the spot; that ended only because no more commands came.",
            gap_m=gap,
        )
        help_ = msg("Publish a Twist of zeros to stop, angular.z as well.")
        return Finding(HALF, joined([text, ending]), help_, (end,))
    text = msg("It stopped by a command, {gap_m:.2f} m from the wall.", gap_m=gap)
    return Finding(1, text, evidence=(end,))
