"""The checks of the square: sides, corners, the return, and the end."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise, takewhile
from typing import Any

from grader.exercise.check import Checks, Tolerances
from grader.exercise.verdict import Finding
from grader.recording.recording import Recording, Recordings
from grader.scenes.turtlesim.driven_path import DrivenPath, Side
from grader.scenes.turtlesim.trace import USUAL_START, TurtleTrace, stands_still
from grader.text.message import NOTHING, Message, joined, msg
from turtlesim_py.world.events import CmdVel
from turtlesim_py.world.turtle import TICK_S

checks = Checks()
#: Why a program passes these that reads no pose.
BY_TIME = "a square that is driven by time is one"
SIDES = 4
#: After a stop at tick t the last reading that differs from the one before is that of t - 1.
STOP_SHOWS = 1


class Way(DrivenPath):
    """The path of turtle1 from where it drove off, until something else than driving moved it.

    Attributes:
        broken_by: what moved it then; nothing where the way lasts as long as the recording.
        moved_away: whether it was put somewhere else before it drove off.
        gap_m: the distance from its start [m], float64 (n,).
        lap_end: the row of its first return, after it had been half a side away; None for none.
        rests: whether it stands still at the end.
    """

    def __init__(self, recording: Recording, tolerances: Tolerances) -> None:
        trace = TurtleTrace.of(recording.trace)
        self.commands, self.tolerances = trace.of_kind(CmdVel), tolerances
        whole = DrivenPath(recording, trace.trajectory())
        path = whole.until_lost().begun_at(recording.start or USUAL_START)
        super().__init__(recording, path.between_jumps().way)
        self.moved_away = bool(path.jumping[path.ticks <= self.ticks[0]].any())
        self.broken_by = NOTHING if whole.lost is None else msg("its pose was no number any more")
        if self.ticks[-1] < path.ticks[-1]:
            self.broken_by = msg("it jumped to another place")
        self.gap_m = self.distance_from(self.x[0], self.y[0])
        self.lap_end = self.first_return(tolerances["return_m"], tolerances["side_m"] / 2)
        self.rests = bool(self.rested_s >= tolerances["rest_s"])

    def straight_sides(self) -> list[Side]:
        """Return the straight sides of its first round: one that goes on has drawn its square."""
        lap = self if self.lap_end is None else self.part(slice(self.lap_end + 1))
        return lap.sides(self.tolerances["corner_size_m"], self.tolerances["side_m"] / 2)


@checks(parrot=BY_TIME)
def drives(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The node drives turtle1.

    turtle1 has driven {driven_m} m or more in the nominal run, by velocity commands, and nothing
    but these moved it between its start and its return. All or nothing. Without it nothing else is
    judged.
    """
    way = Way(recordings.nominal, tolerances)
    values = {"way_m": way.length_m, "commands": len(way.commands), "what": way.broken_by}
    text = msg("turtle1 drove {way_m:.2f} m by {commands} velocity commands.", **values)
    if not way.commands:
        help_ = msg("Does your node publish on turtle1's topic, and is it spinning?")
        return Finding(0, msg("No velocity command came to turtle1."), help_)
    if way.length_m < tolerances["driven_m"]:
        return Finding(0, text, msg("Which speed in your commands moves a turtle ahead?"))
    if way.broken_by:
        text = msg("turtle1 drove {way_m:.2f} m, then {what}.", **values)
        help_ = msg("Until its return, move turtle1 by velocity commands only, of finite numbers.")
        return Finding(0, text, help_, (way.evidence(-1, way.broken_by),))
    return Finding(1, text)


@checks(after=("drives",), parrot=BY_TIME)
def sides(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The way has four sides of about 2 m.

    The way is drawn with straight lines, as with a ruler: a bend that stands out by less than
    {corner_size_m} m is no corner. A side is right if it is {side_m} m long, give or take
    {side_error_m} m. The points are the number of right sides, four at most, divided by the number
    of sides or by four, whichever is more: 3 right sides of 5 are 3/5 of the points.

    Sides, corners and straightness are those of the first round: what turtle1 drives after its
    first return, {return_m} m or less from its start, counts for `returns` alone.
    """
    way = Way(recordings.nominal, tolerances)
    found = [(side.last, side.length_m) for side in way.straight_sides()]
    near = {"wanted": tolerances["side_m"], "error": tolerances["side_error_m"]}
    help_ = msg("A side is the speed [m/s] times its duration. Which side is wrong or missing?")
    return _four(way, found, help_, what=msg("sides"), unit=msg("m long"), **near)


@checks(after=("drives",), parrot=BY_TIME)
def corners(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """It has four corners of about 90 degrees, all to the same hand.

    A corner is right if the way turns in it by 90 degrees, give or take {corner_error_deg}, to the
    hand to which most corners turn. The start is a corner, too, if the way leads back to it. The
    points are counted as for the sides.
    """
    way = Way(recordings.nominal, tolerances)
    turns = [(side.last, side.turn_deg) for side in way.straight_sides()]
    found = [(row, turn) for row, turn in turns if turn is not None]
    left = sum(turn > 0 for _, turn in found) * 2 >= len(found)
    near = {"wanted": 90 if left else -90, "error": tolerances["corner_error_deg"]}
    help_ = msg("A turn is the speed [rad/s] times its duration. Which corner is wrong or missing?")
    return _four(way, found, help_, what=msg("corners"), unit=msg("degrees to the left"), **near)


def _four(way: Way, found: list[tuple[int, float]], help_: Message, **values: Any) -> Finding:
    """Judge rows and sizes of sides or corners: four should be as `wanted`, by an `error`."""
    wrong = [each for each in found if abs(each[1] - values["wanted"]) > values["error"]]
    shown = [f"{size:.3g}" for _, size in found[:8]] + ["..."] * (len(found) > 8)
    counts = {"right": len(found) - len(wrong), "n": len(found)}
    text = msg(
        "{what!u}: {sizes} {unit}; {right} of {n} within {error} of {wanted}. Expected: four.",
        **{"sizes": ", ".join(shown), **values, **counts},
    )
    share = min(counts["right"], SIDES) / max(len(found), SIDES)
    notes = [(row, msg("{size:.3g} {unit}", size=size, **values)) for row, size in wrong[:SIDES]]
    where = tuple(way.evidence(*note) for note in notes)
    return Finding(share, text if found else msg("The way has no corner."), help_, where)


@checks(after=("drives", "corners"), parrot=BY_TIME)
def straight(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The sides are straight.

    Between its corners the way lies {crooked_m} m at most beside the straight line. The points are
    the part of the sides for which that holds.
    """
    way = Way(recordings.nominal, tolerances)
    found = sorted(way.straight_sides(), key=lambda side: -side.crooked_m)
    crooked = [side for side in found if side.crooked_m > tolerances["crooked_m"]]
    text = msg(
        "{crooked} of {sides} sides are crooked, by up to {beside_m:.2f} m; {limit_m} m is fine.",
        **{"crooked": len(crooked), "sides": len(found), "beside_m": found[0].crooked_m},
        limit_m=tolerances["crooked_m"],
    )
    help_ = msg("In a corner the way may be round: does the turtle turn between corners, too?")
    note = msg("beside the straight line")
    where = tuple(way.evidence(side.crooked_at, note) for side in crooked[:SIDES])
    return Finding(1 - len(crooked) / len(found), text, help_, where)


@checks(after=("drives",), parrot=BY_TIME)
def returns(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """It comes to rest where it started, after one round.

    It comes to rest {return_m} m or less from its start, and drives on for no more than
    {further_m} m after its first return. Half of the points if it comes to rest {near_m} m or less
    from its start, or was there before and drove on.
    """
    way = Way(recordings.nominal, tolerances)
    limit_m, gap_m = tolerances["return_m"], float(way.gap_m[-1])
    values = {"gap_m": gap_m, "limit_m": limit_m}
    text = msg("turtle1 never came to rest.")
    if way.rests:
        text = msg("It rests {gap_m:.2f} m from its start; {limit_m} m is fine.", **values)
    here = way.evidence(-1, msg("{gap_m:.2f} m from its start", **values))
    if way.lap_end is None:
        text = joined([text, msg("It drove no full round.")], " ")
        help_ = msg("Errors in sides and corners add up. Which side does not fit its opposite?")
        is_near = way.rests and limit_m < gap_m <= tolerances["near_m"]
        return Finding(0.5 if is_near else 0, text, help_, (here,))
    further_m = way.length_from(way.lap_end)
    more = msg("It drove on for {further_m:.2f} m after its first return.", further_m=further_m)
    help_ = msg("The square is done when the turtle is back: how does your node notice?")
    is_right = way.rests and gap_m <= limit_m and further_m <= tolerances["further_m"]
    where = (way.evidence(way.lap_end, msg("back for the first time")), here)
    return Finding(1 if is_right else 0.5, joined([text, more], " "), help_, where)


@checks(after=("drives",), parrot=BY_TIME)
def stops(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """A command brings it to rest.

    A command of speed 0 ends the motion, and turtle1 then rests for {rest_s} s. Half of the points
    if it rests only because no more commands come: the simulator stops a turtle a second after its
    last command.
    """
    way = Way(recordings.nominal, tolerances)
    if way.rests:
        where = (way.evidence(way.rest, msg("here it came to rest")),)
        *_, stop = None, *takewhile(stands_still, reversed(way.commands))
        if stop is not None and stop.tick <= way.ticks[way.rest] + STOP_SHOWS:
            text = msg("A command of speed 0 came at {time_s:.2f} s.", time_s=stop.tick * TICK_S)
            return Finding(1, text, evidence=where)
        text = msg("turtle1 rests since the simulator stopped it, a second after the last command.")
        help_ = msg("To stop publishing is no stop. What must the last command say?")
        return Finding(0.5, text, help_, where)
    for stop, further in pairwise(way.commands if way.lap_end is not None else ()):
        is_back = stop.tick + STOP_SHOWS >= way.ticks[way.lap_end]
        is_near = way.gap_m[way.row_at(stop.tick)] <= tolerances["near_m"]
        if is_back and is_near and stands_still(stop) and not stands_still(further):
            text = msg(
                "turtle1 was stopped at {stop_s:.2f} s, back at its start, and then your node sent "
                "another command, to drive on, at {further_s:.2f} s.",
                **{"stop_s": stop.tick * TICK_S, "further_s": further.tick * TICK_S},
            )
            help_ = msg("What else publishes velocities, and how does it learn of the stop?")
            told = way.at(stop.tick, msg("told to stop here"))
            return Finding(0, text, help_, (told, way.at(further.tick, msg("told to drive on"))))
    end = way.evidence(-1, msg("still moving"))
    text = msg("turtle1 was still moving at the end, {time_s:.1f} s.", time_s=end.time_s)
    help_ = msg("How does your node know that it is done, and what does it tell the turtle then?")
    return Finding(0, text, help_, (end,))


@checks(after=("drives",), parrot=BY_TIME)
def anywhere(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """It draws the square from any start.

    In every run that starts elsewhere, sides, corners, straightness and return are judged as
    above, each a quarter. The points are the mean of these runs; one in which the node has turtle1
    put somewhere else first counts as nothing.
    """
    if not recordings.varied:
        raise ValueError("'anywhere' has points, and the exercise no varied_runs: expected both")
    shares, sentences, evidence = [], [], []
    for number, recording in enumerate(recordings.varied, start=1):
        found = _square(Recordings(recording), tolerances)
        wrong = [finding for finding in found if finding.share < 1]
        where = [item for finding in wrong for item in finding.evidence[:1]]
        seen = [finding.rationale for finding in wrong] or [msg("A right square.")]
        shares.append(sum(finding.share for finding in found) / 4)
        start = recording.start or USUAL_START
        pose = {"x": start.x, "y": start.y, "theta": start.theta}
        run = msg("Run {run}, from ({x:.2f}, {y:.2f}, {theta:.2f} rad):", run=number, **pose)
        sentences += [run, *seen]
        evidence += [replace(item, run=number) for item in where[:2]]
    help_ = msg(
        "Does your node assume where the turtle starts, or which way it looks? Whatever is wrong "
        "in the nominal run is wrong here too: fix that first."
    )
    return Finding(sum(shares) / len(shares), joined(sentences, " "), help_, tuple(evidence))


def _square(alone: Recordings, tolerances: Tolerances) -> list[Finding]:
    """Judge a run from elsewhere: four findings, or fewer where the others are worth nothing."""
    way = Way(alone.nominal, tolerances)
    if way.moved_away:
        text = msg("It does not count: your node moved the turtle elsewhere before it drove.")
        return [Finding(0, text, evidence=(way.evidence(0, msg("here it drove off")),))]
    if (driven := drives(alone, tolerances)).share < 1:
        return [driven]
    found = [check(alone, tolerances) for check in (sides, corners, returns)]
    return [*found, straight(alone, tolerances)] if found[1].share >= 1 else found
