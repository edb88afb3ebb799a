"""The checks of the square: sides, corners, the return, and the end."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from grader.exercise.asking import CheckFunction
from grader.exercise.check import Checks, Tolerances
from grader.exercise.verdict import Evidence, Finding
from grader.exercises.square.way import Way
from grader.message import Message, joined, msg, msg_many
from grader.recording.recording import Recording, Recordings
from grader.text import place
from turtlesim_py.world.turtle import TICK_S

checks = Checks()
Judge = Callable[[Way], Finding]
#: Functions that judge one way, by the check's name.
JUDGES: dict[str, Judge] = {}
SIDES = 4


def of_one_way(judge: Judge) -> CheckFunction:
    """Make a check of the nominal run from a function that judges one way.

    That one's rationale is a clause, without a full stop: several may be in one sentence.
    """

    def check(recordings: Recordings, tolerances: Tolerances) -> Finding:
        finding = judge(Way(recordings.nominal, tolerances))
        return replace(finding, rationale=msg("{clause}.", clause=finding.rationale))

    check.__name__, check.__doc__ = judge.__name__, judge.__doc__
    JUDGES[judge.__name__] = judge
    return check


@checks()
def drives(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The node drives turtle1.

    turtle1 has driven {driven_m} m or more in the nominal run, by velocity commands, and nothing
    but these moved it between its start and its return. All or nothing. Without it nothing else is
    judged.
    """
    way = Way(recordings.nominal, tolerances)
    if not way.commands:
        return Finding(
            0,
            msg("No velocity command came to turtle1."),
            msg("Does your node publish on the topic that turtle1 listens to, and is it spinning?"),
        )
    if way.length_m < tolerances["driven_m"]:
        return Finding(
            0,
            msg(
                "{commands} velocity commands came, but turtle1 drove {way_m:.2f} m.",
                commands=len(way.commands),
                way_m=way.length_m,
            ),
            msg("Look at what your commands contain: which speed moves a turtle ahead?"),
        )
    if way.broken_by:
        return Finding(
            0,
            msg(
                "turtle1 drove {way_m:.2f} m, then {what}.", way_m=way.length_m, what=way.broken_by
            ),
            msg(
                "Only velocity commands should move the turtle between its start and its return, "
                "and they must hold finite numbers."
            ),
            (way.evidence(-1, msg("after this, {what}", what=way.broken_by)),),
        )
    text = msg(
        "turtle1 drove {way_m:.2f} m by {commands} velocity commands.",
        way_m=way.length_m,
        commands=len(way.commands),
    )
    return Finding(1, text)


@checks(after=("drives",))
@of_one_way
def sides(way: Way) -> Finding:
    """The way has four sides of about 2 m.

    The way is drawn with straight lines, as with a ruler: a bend that stands out by less than
    {corner_size_m} m is no corner. A side is right if it is {side_m} m long, give or take
    {side_error_m} m. The points are the number of right sides, four at most, divided by the number
    of sides or by four, whichever is more: 3 right sides of 5 are 3/5 of the points.
    """
    wanted, error = way.tolerances["side_m"], way.tolerances["side_error_m"]
    found = way.sides
    good = [abs(side.length_m - wanted) <= error for side in found]
    seen = msg_many(
        "{n} straight side, {lengths} m long",
        "{n} straight sides, {lengths} m long",
        len(found),
        lengths=some([f"{side.length_m:.2f}" for side in found]),
    )
    near = {"seen": seen, "error_m": error, "wanted_m": wanted}
    if all(good) and len(found) == SIDES:
        return Finding(1, msg("{seen}: four, within {error_m} m of {wanted_m} m", **near))
    return Finding(
        part(sum(good), len(found)),
        msg(
            "{seen}; {right} of them within {error_m} m of {wanted_m} m. There should be {sides}",
            right=sum(good),
            sides=SIDES,
            **near,
        ),
        msg(
            "How far a turtle gets is its speed times how long it drives. Which of your sides is "
            "too long, too short, missing, or too many?"
        ),
        tuple(
            way.evidence(
                side.last, msg("here ends a side of {length_m:.2f} m", length_m=side.length_m)
            )
            for side, is_good in zip(found, good, strict=True)
            if not is_good
        )[:SIDES],
    )


@checks(after=("drives",))
@of_one_way
def corners(way: Way) -> Finding:
    """It has four corners of about 90 degrees, all to the same hand.

    A corner is right if the way turns in it by 90 degrees, give or take {corner_error_deg}, to the
    hand to which most corners turn. The start is a corner, too, if the way leads back to it. The
    points are counted as for the sides.
    """
    error = way.tolerances["corner_error_deg"]
    found = way.corners
    left = sum(corner.turn_deg > 0 for corner in found) * 2 >= len(found)
    good = [abs((c.turn_deg if left else -c.turn_deg) - 90.0) <= error for c in found]
    if not found:
        return Finding(
            0,
            msg("The way has no corner"),
            msg("The turtle has to stop going ahead, turn on the spot, and go on."),
            (way.evidence(-1, msg("no corner up to here")),),
        )
    seen = msg_many(
        "{n} corner, turning by {turns} degrees (+ is to the left)",
        "{n} corners, turning by {turns} degrees (+ is to the left)",
        len(found),
        turns=some([f"{corner.turn_deg:+.0f}" for corner in found]),
    )
    if all(good) and len(found) == SIDES:
        text = msg("{seen}: four, within {error_deg} degrees of 90", seen=seen, error_deg=error)
        return Finding(1, text)
    return Finding(
        part(sum(good), len(found)),
        msg(
            "{seen}; {right} of them within {error_deg} degrees of 90 to the same hand. There "
            "should be {corners}; the start counts as one if the way leads back to it",
            seen=seen,
            right=sum(good),
            error_deg=error,
            corners=SIDES,
        ),
        msg(
            "How far a turtle turns is its angular speed times how long it turns, in radians. By "
            "how much does it have to turn in a corner of a square, and how often?"
        ),
        tuple(
            way.evidence(corner.index, msg("a turn by {turn:+.0f} degrees", turn=corner.turn_deg))
            for corner, is_good in zip(found, good, strict=True)
            if not is_good
        )[:SIDES],
    )


@checks(after=("drives", "corners"))
@of_one_way
def straight(way: Way) -> Finding:
    """The sides are straight.

    Between its corners the way lies {crooked_m} m at most beside the straight line. The points are
    the part of the sides for which that holds.
    """
    limit = way.tolerances["crooked_m"]
    found = way.sides
    crooked = [side for side in found if side.crooked_m > limit]
    worst = max(found, key=lambda side: side.crooked_m)
    if not crooked:
        return Finding(
            1,
            msg(
                "The way lies at most {beside_m:.2f} m beside its sides; {limit_m} m is fine",
                beside_m=worst.crooked_m,
                limit_m=limit,
            ),
        )
    return Finding(
        1 - len(crooked) / len(found),
        msg(
            "{crooked} of {sides} sides are crooked: the way lies up to {beside_m:.2f} m beside "
            "the straight line; {limit_m} m is fine",
            crooked=len(crooked),
            sides=len(found),
            beside_m=worst.crooked_m,
            limit_m=limit,
        ),
        msg(
            "Does the turtle turn while it goes ahead? In the middle of a side it should not; in a "
            "corner the way may be a little round."
        ),
        tuple(
            way.evidence(
                side.crooked_at,
                msg("{beside_m:.2f} m beside the straight line", beside_m=side.crooked_m),
            )
            for side in crooked
        )[:SIDES],
    )


@checks(after=("drives",))
@of_one_way
def returns(way: Way) -> Finding:
    """It comes to rest where it started, after one round.

    It comes to rest {return_m} m or less from its start, and drives on for no more than
    {further_m} m after its first return. Half of the points if it comes to rest {near_m} m or less
    from its start, or was there before and drove on.
    """
    if not way.rests:
        return _never_at_rest(way)
    gap = float(way.gap_m[-1])
    here = way.evidence(-1, msg("here it came to rest, {gap_m:.2f} m from its start", gap_m=gap))
    seen = msg(
        "turtle1 started at {start} and came to rest at {end}, {gap_m:.2f} m away",
        start=way.place(0),
        end=way.place(-1),
        gap_m=gap,
    )
    fine = msg("{seen}; {limit_m} m is fine", seen=seen, limit_m=way.tolerances["return_m"])
    if gap > way.tolerances["return_m"]:
        near = gap <= way.tolerances["near_m"]
        return Finding(
            0.5 if near or way.lap_end is not None else 0,
            fine,
            msg(
                "Errors in sides and corners add up. Which of the sides does not fit the one "
                "opposite?"
            ),
            (here,),
        )
    help_ = msg("Once round is enough: how many sides does your node drive?")
    if way.lap_end is None:
        return Finding(0, msg("{seen}, but it was never away", seen=seen), help_, (here,))
    further = way.length_from(way.lap_end)
    if further > way.tolerances["further_m"]:
        text = msg(
            "{seen}, but it had been back and drove on for {further_m:.2f} m",
            seen=seen,
            further_m=further,
        )
        back = msg("back for the first time, {further_m:.2f} m before the end", further_m=further)
        return Finding(0.5, text, help_, (way.evidence(way.lap_end, back), here))
    return Finding(1, fine, evidence=(here,))


def _never_at_rest(way: Way) -> Finding:
    help_ = msg("The square is done when the turtle is back: how does your node notice?")
    start = way.place(0)
    if way.lap_end is None:
        text = msg(
            "turtle1 started at {start}, did not return to it, and never came to rest", start=start
        )
        return Finding(0, text, help_, (way.evidence(-1, msg("did not return to it")),))
    text = msg(
        "turtle1 started at {start}, returned to it and drove on, and never came to rest",
        start=start,
    )
    note = msg("returned to it and drove on")
    return Finding(0.5, text, help_, (way.evidence(way.lap_end, note),))


@checks(after=("drives",))
def stops(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """A command brings it to rest.

    A command of speed 0 ends the motion, and turtle1 then rests for {rest_s} s. Half of the points
    if it rests only because no more commands come: the simulator stops a turtle a second after its
    last command.
    """
    way = Way(recordings.nominal, tolerances)
    if not way.rests:
        return _unrested(way)
    tick = way.stop_command()
    if tick is None:
        return Finding(
            0.5,
            msg(
                "turtle1 rests only because no more commands came: the simulator stops a turtle "
                "one second after its last command. No command of speed 0 came while it was "
                "moving."
            ),
            msg(
                "If your node just stops publishing, that is no stop. What must the last "
                "command say?"
            ),
            (way.evidence(way.rest, msg("it came to rest without a command")),),
        )
    text = msg(
        "A command of speed 0 came at {time_s:.2f} s; turtle1 then rested for {rested_s:.1f} s.",
        time_s=tick * TICK_S,
        rested_s=way.rested_s,
    )
    return Finding(1, text, evidence=(way.evidence(way.rest, msg("here it came to rest")),))


def _unrested(way: Way) -> Finding:
    """Judge a run that is moving at its end."""
    drove_on = way.stopped_and_drove_on()
    if drove_on is not None:
        stop, further = (command.tick for command in drove_on)
        return Finding(
            0,
            msg(
                "turtle1 was stopped at {stop_s:.2f} s, back at its start, and then your "
                "node sent another command, to drive on, at {further_s:.2f} s.",
                stop_s=stop * TICK_S,
                further_s=further * TICK_S,
            ),
            msg(
                "What else in your node publishes velocities, and how does it learn that the "
                "turtle has to stand still?"
            ),
            (way.at(stop, msg("told to stop here")), way.at(further, msg("told to drive on"))),
        )
    return Finding(
        0,
        msg(
            "turtle1 was still moving when the run ended after {seconds:.1f} s.",
            seconds=way.recording.run.simulated_s,
        ),
        msg("How does your node know that it is done, and what does it tell the turtle then?"),
        (way.evidence(-1, msg("still moving")),),
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
    sentences: list[Message] = []
    evidence: list[Evidence] = []
    for number, recording in enumerate(recordings.varied, start=1):
        share, wrong, where = _square(Way(recording, tolerances, number))
        shares.append(share)
        evidence += where[:2]
        sentences.append(
            msg(
                "Run {run} ({start}): {seen}.",
                run=number,
                start=start_of(recording),
                seen=wrong or msg("a right square"),
            )
        )
    help = msg(
        "Does your node assume where the turtle starts, or which way it looks? Whatever is "
        "wrong in the nominal run is wrong here too: fix that first."
    )
    return Finding(float(np.mean(shares)), joined(sentences, " "), help, tuple(evidence))


def _square(way: Way) -> tuple[float, Message, list[Evidence]]:
    """Judge a run from elsewhere: the share that is right, what is wrong, and where."""
    if way.moved_away:
        why = msg("it does not count, because your node moved the turtle elsewhere before it drove")
        return 0.0, why, [way.evidence(0, msg("here it drove off"))]
    if way.length_m < way.tolerances["driven_m"]:
        return 0.0, msg("it drove {way_m:.2f} m", way_m=way.length_m), []
    if way.broken_by:
        note = msg("after this, {what}", what=way.broken_by)
        return 0.0, way.broken_by, [way.evidence(-1, note)]
    findings = [JUDGES[name](way) for name in ("sides", "corners", "returns")]
    if findings[1].share >= 1:
        findings.append(JUDGES["straight"](way))
    wrong = [finding for finding in findings if finding.share < 1]
    share = sum(finding.share for finding in findings) / 4
    text = joined([finding.rationale for finding in wrong], msg("; "))
    return share, text, [item for finding in wrong for item in finding.evidence[:1]]


def start_of(recording: Recording) -> Message:
    """Say where a varied run started."""
    start = recording.start
    if start is None:
        return msg("from the usual start")
    return msg(
        "from {place}, heading {heading:.0f} degrees",
        place=place(start.x, start.y),
        heading=math.degrees(start.theta),
    )


def part(good: int, found: int) -> float:
    """Return the share for so many right ones out of so many, where four are wanted."""
    return min(good, SIDES) / max(found, SIDES)


def some(texts: list[str]) -> Message:
    """Join the first of many texts."""
    return joined([*texts[:8], *(["..."] if len(texts) > 8 else [])], ", ")
