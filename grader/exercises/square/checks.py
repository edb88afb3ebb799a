"""What is looked at: sides, corners, the return, and the end."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np

from grader.exercise.check import Checks, Tolerances
from grader.exercise.verdict import Evidence, Finding
from grader.exercises.square.shape import (
    judge_corners,
    judge_returns,
    judge_sides,
    judge_square,
    judge_straight,
)
from grader.exercises.square.way import Way
from grader.language.phrase import Phrase, joined, say
from grader.recording.recording import Recording, Recordings
from grader.scenes.turtlesim.trace import TurtleTrace
from grader.text import place
from turtlesim_py.world.events import CmdVel
from turtlesim_py.world.turtle import TICK_S

#: The row of a command's own tick shows what it did: after a stop at tick t the last row that
#: differs from the one before is t - 1.
STOP_SHOWS = 1
checks = Checks()


@checks()
def drives(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The node drives turtle1.

    turtle1 has driven {driven_m} m or more in the nominal run, by velocity commands, and nothing
    but these moved it between its start and its return. All or nothing. Without it nothing else is
    judged.
    """
    recording = recordings.nominal
    commands = TurtleTrace.of(recording.trace).of_kind(CmdVel)
    if not commands:
        return Finding(
            0,
            say("No velocity command came to turtle1."),
            say("Does your node publish on the topic that turtle1 listens to, and is it spinning?"),
        )
    way = Way(recording)
    if way.length_m < tolerances["driven_m"]:
        return Finding(
            0,
            say(
                "{commands} velocity commands came, but turtle1 drove {way_m:.2f} m.",
                commands=len(commands),
                way_m=way.length_m,
            ),
            say("Look at what your commands contain: which speed moves a turtle ahead?"),
        )
    if way.broken_by:
        return Finding(
            0,
            say(
                "turtle1 drove {way_m:.2f} m, then {what}.", way_m=way.length_m, what=way.broken_by
            ),
            say(
                "Only velocity commands should move the turtle between its start and its return, "
                "and they must hold finite numbers."
            ),
            (way.evidence(-1, say("after this, {what}", what=way.broken_by)),),
        )
    text = say(
        "turtle1 drove {way_m:.2f} m by {commands} velocity commands.",
        way_m=way.length_m,
        commands=len(commands),
    )
    return Finding(1, text)


@checks(after=("drives",))
def sides(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The way has four sides of about 2 m.

    The way is drawn with straight lines, as with a ruler: a bend that stands out by less than
    {corner_size_m} m is no corner. A side is right if it is {side_m} m long, give or take
    {side_error_m} m. The points are the number of right sides, four at most, divided by the number
    of sides or by four, whichever is more: 3 right sides of 5 are 3/5 of the points.
    """
    return sentence(judge_sides(Way(recordings.nominal), tolerances))


@checks(after=("drives",))
def corners(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """It has four corners of about 90 degrees, all to the same hand.

    A corner is right if the way turns in it by 90 degrees, give or take {corner_error_deg}, to the
    hand to which most corners turn. The start is a corner, too, if the way leads back to it. The
    points are counted as for the sides.
    """
    return sentence(judge_corners(Way(recordings.nominal), tolerances))


@checks(after=("drives", "corners"))
def straight(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The sides are straight.

    Between its corners the way lies {crooked_m} m at most beside the straight line. The points are
    the part of the sides for which that holds.
    """
    return sentence(judge_straight(Way(recordings.nominal), tolerances))


@checks(after=("drives",))
def returns(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """It comes to rest where it started, after one round.

    It comes to rest {return_m} m or less from its start, and drives on for no more than
    {further_m} m after its first return. Half of the points if it comes to rest {near_m} m or less
    from its start, or was there before and drove on.
    """
    return sentence(judge_returns(Way(recordings.nominal), tolerances))


@checks(after=("drives",))
def stops(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """A command brings it to rest.

    A command of speed 0 ends the motion, and turtle1 then rests for {rest_s} s. Half of the points
    if it rests only because no more commands come: the simulator stops a turtle a second after its
    last command.
    """
    recording = recordings.nominal
    way = Way(recording)
    if not way.rests(tolerances):
        return _unrested(way, stopped_and_drove_on(recording, way, tolerances))
    tick = stop_command(recording, int(way.ticks[way.rest]))
    if tick is None:
        return Finding(
            0.5,
            say(
                "turtle1 rests because no commands came any more: the simulator stops a turtle one "
                "second after its last command. None of speed 0 came while it was moving."
            ),
            say("Ceasing to publish is not stopping. What must the last command say?"),
            (way.evidence(way.rest, say("it came to rest without a command")),),
        )
    text = say(
        "A command of speed 0 came at {time_s:.2f} s; turtle1 then rested for {rested_s:.1f} s.",
        time_s=tick * TICK_S,
        rested_s=way.rested_s,
    )
    return Finding(1, text, evidence=(way.evidence(way.rest, say("here it came to rest")),))


def _unrested(way: Way, drove_on: tuple[CmdVel, CmdVel] | None) -> Finding:
    """It moves at the end."""
    if drove_on is not None:
        stop, further = (command.tick for command in drove_on)
        return Finding(
            0,
            say(
                "turtle1 was stopped at {stop_s:.2f} s, back at its start, and then your "
                "node sent another command, to drive on, at {further_s:.2f} s.",
                stop_s=stop * TICK_S,
                further_s=further * TICK_S,
            ),
            say(
                "What else in your node publishes velocities, and how does it learn that the "
                "turtle is to stand?"
            ),
            (way.at(stop, say("told to stop here")), way.at(further, say("told to drive on"))),
        )
    return Finding(
        0,
        say(
            "turtle1 was still moving when the run ended after {seconds:.1f} s.",
            seconds=way.recording.run.simulated_s,
        ),
        say("How does your node know that it is done, and what does it tell the turtle then?"),
        (way.evidence(-1, say("still moving")),),
    )


@checks(after=("drives",))
def anywhere(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """It draws the square from any start.

    In every run that starts elsewhere, sides, corners, straightness and return are judged as
    above, each a quarter. The points are the mean of these runs; one in which the node has turtle1
    put somewhere else first counts as nothing.
    """
    if not recordings.varied:
        raise ValueError(
            "there is no run from elsewhere: the exercise needs varied_runs, or no points for "
            "'anywhere'"
        )
    shares: list[float] = []
    sentences: list[str] = []
    evidence: list[Evidence] = []
    for number, recording in enumerate(recordings.varied, start=1):
        share, wrong, where = judge_square(Way(recording, number), tolerances)
        shares.append(share)
        evidence += where[:2]
        sentences.append(
            say(
                "Run {run} ({start}): {seen}.",
                run=number,
                start=start_of(recording),
                seen=wrong or say("a right square"),
            )
        )
    help = say(
        "Does your node take for granted where the turtle starts, or which way it looks? Whatever "
        "is wrong in the nominal run is wrong here too: mend that first."
    )
    return Finding(float(np.mean(shares)), joined(sentences, " "), help, tuple(evidence))


def sentence(finding: Finding) -> Finding:
    """What a clause tells, as a sentence."""
    return replace(finding, rationale=say("{clause}.", clause=finding.rationale))


def stop_command(recording: Recording, last_motion: int) -> int | None:
    """The tick of the command that stopped turtle1, if one did."""
    found = None
    for command in reversed(TurtleTrace.of(recording.trace).of_kind(CmdVel)):
        if not is_stop(command):
            break
        found = command.tick
    return found if found is not None and found <= last_motion + STOP_SHOWS else None


def stopped_and_drove_on(
    recording: Recording, way: Way, tolerances: Tolerances
) -> tuple[CmdVel, CmdVel] | None:
    """The first command to stand after the return, near the start, and the one that ended it."""
    lap_end = way.return_to_start(tolerances)
    if lap_end is None:
        return None
    since = int(way.ticks[lap_end])
    commands = TurtleTrace.of(recording.trace).of_kind(CmdVel)
    for stop, further in pairwise(commands):
        row = min(int(np.searchsorted(way.ticks, stop.tick)), len(way) - 1)
        is_back = stop.tick + STOP_SHOWS >= since and way.gap_m[row] <= tolerances["near_m"]
        if is_back and is_stop(stop) and not is_stop(further):
            return stop, further
    return None


def is_stop(command: CmdVel) -> bool:
    """Whether a velocity command says to stand still."""
    return command.linear[0] == 0 and command.angular[2] == 0


def start_of(recording: Recording) -> Phrase:
    """Where a varied run started."""
    start = recording.start
    if start is None:
        return say("from the usual start")
    return say(
        "from {place}, heading {heading:.0f} degrees",
        place=place(start.x, start.y),
        heading=math.degrees(start.theta),
    )
