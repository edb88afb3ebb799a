"""How the turtle of one run came to rest."""

from __future__ import annotations

from grader.exercise.check import Tolerances
from grader.exercise.sentences import how_it_ended
from grader.exercise.verdict import Finding
from grader.exercises.turtlesim_challenge.path import Path
from turtlesim_py.world.events import CmdVel
from turtlesim_py.world.turtle import TICK_S


def judge_stop(path: Path, tolerances: Tolerances) -> Finding:
    """Whether a run ended at rest near an edge, by a command, without touching a wall."""
    run = path.recording.run
    ending = how_it_ended(path.recording)
    void = judge_start(path)
    if void is not None:
        return void
    if path.wall is not None:
        touched = path.at(int(path.ticks[path.wall]), "it touches the wall here")
        return Finding(
            0,
            f"The turtle ran into a wall at {touched.time_s:.1f} s.",
            "Watch the pose, and stop before a wall is reached.",
            (touched,),
        )
    if path.lost_tick is not None:
        lost = path.at(path.lost_tick, "the last place it was at")
        return Finding(
            0,
            f"At {lost.time_s:.1f} s your node sent a velocity that is not a number, and the "
            "turtle was nowhere from then on.",
            "Which division or logarithm can give nan or inf?",
            (lost,),
        )
    end = path.at(path.stop_tick, "the last place it moved to")
    if path.last >= len(path) - 2:
        return Finding(
            0,
            f"The turtle was still moving after {run.simulated_s:.0f} s.",
            "Compare x and y of the pose with the size of the window, and publish a zero Twist.",
            (end,),
        )
    gap = float(path.wall_distance[path.last])
    if gap > tolerances["edge_m"]:
        return Finding(
            0,
            f"The turtle came to rest {gap:.2f} m from the nearest wall; "
            f"{tolerances['edge_m']:g} m or less is near.{ending}",
            "What should make it stop is the pose, near an edge.",
            (end,),
        )
    # The stop that counts is the command that was in force when the turtle came to rest.
    commands = [call for call in path.calls(CmdVel) if call.tick <= path.stop_tick + 1]
    if not commands or not _stands_still(commands[-1]):
        return Finding(
            0,
            f"The turtle came to rest {gap:.2f} m from the wall because no more commands came, "
            f"not because it was told to stop.{ending}",
            "Publish a Twist of zeros to stop.",
            (end,),
        )
    return Finding(1, f"stopped by a command, {gap:.2f} m from the wall", evidence=(end,))


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


def _stands_still(command: CmdVel) -> bool:
    return not command.linear[0] and not command.angular[2]
