"""The checks of the hunt, by the simulator's world alone: who lived when, and who was near."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from grader.exercise.check import Checks, Tolerances
from grader.exercise.verdict import Evidence, Finding
from grader.recording.recording import Recordings
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from grader.text.message import Message, msg
from turtlesim_py.world.arena import TICK_NS
from turtlesim_py.world.events import Kill
from turtlesim_py.world.trajectory import Trajectory

checks = Checks()
STEP_S = TICK_NS / 1e9
#: So few places may lie in a line by chance.
FEW = 4
NONE = msg("No turtle was spawned.")
SPAWN = msg("Does the spawner reach /spawn, and does its timer run?")


class Life(NamedTuple):
    """A turtle, other than turtle1, from its first tick to its last.

    Attributes:
        born_m, way_m: how far turtle1 was at its beginning, and at its end [m]; inf where there was
            none.
        ahead_m: how near turtle1 comes to where it began while it lives if it drives on as it did
            then [m].
        is_killed: whether it was killed, and not still there at the end of the run.
    """

    name: str
    first: int
    last: int
    x: float
    y: float
    born_m: float
    way_m: float
    ahead_m: float
    is_killed: bool


@checks(parrot="who spawns needs to hear nothing")
def spawns(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Turtles are spawned again and again.

    The first at most {first_s} s after the start, and the next at most {spawn_s} s after the one
    before, or after fewer than {most_alive} lived again; {slack_s} s more cost nothing. What
    counts is the share of the waits that are no longer. The places are random: along x and y they
    deviate from their mean by {spread_m} m or more (standard deviation). Others count for nothing,
    here and below.
    """
    trace = TurtleTrace.of(recordings.nominal.trace)
    lives = _lives(trace)
    if not lives:
        return Finding(0, NONE, SPAWN)
    if (spread_m := _spread(lives)) < tolerances["spread_m"]:
        text = msg("Turtles were spawned all in one place or line: they deviate by {way:.2f} m.",
                   way=spread_m)  # fmt: skip
        return Finding(0, text, msg("Draw each place from the whole window."))
    waits = _waits(trace, lives, tolerances["most_alive"])
    most = [tolerances["spawn_s"]] * len(waits)
    most[0] = tolerances["first_s"]
    late = [
        (since_s, wait_s)
        for (since_s, wait_s), most_s in zip(waits, most, strict=True)
        if wait_s > most_s + tolerances["slack_s"]
    ]
    text = msg("{n} turtles were spawned, each in time.", n=len(lives))
    if not late:
        return Finding(1, text)
    worst_s = max(wait_s for _, wait_s in late)
    text = msg("{late} of {n} waits for a turtle were too long, the longest {worst:.1f} s.",
               late=len(late), n=len(waits), worst=worst_s)  # fmt: skip
    since_s = late[0][0]
    seen = (Evidence(since_s, msg("here a wait begins"), tick=round(since_s / STEP_S)),)
    help_ = msg("Does the timer of the spawner run, and often enough?")
    return Finding(1 - len(late) / len(waits), text, help_, seen)


@checks()
def catches(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """turtle1 catches eight.

    At least {least} turtles are killed when turtle1 is within {catch_m} m of them. Fewer are a part
    of the points; each that is killed from afar takes one back. One that is spawned within {born_m}
    m of turtle1, or where it comes anyway if it drives on as it did, does not count, here and
    below. In one more run turtle1 starts elsewhere; the worse counts, here and below.
    """
    return _worst(_catches(_lives(trace), tolerances) for trace in _traces(recordings))


def _catches(lives: list[Life], tolerances: Tolerances) -> Finding:
    least = tolerances["least"]
    killed = _prey(lives, tolerances)
    caught = [each for each in killed if each.way_m <= tolerances["catch_m"]]
    text = msg("Turtles that turtle1 caught: {n}, expected {least}.", n=len(caught), least=least)
    far = len(killed) - len(caught)
    if len(caught) - far >= least:
        return Finding(1, text)
    help_ = msg("Is turtle1 fast enough, and does it take the nearest first?")
    if far:
        text = msg("{text} {n} were killed from afar.", text=text, n=far)
        help_ = msg("Kill a turtle only when turtle1 says that it is there.")
    elif len(lives) < least:
        text = msg("{text} Spawned were {n} in all.", text=text, n=len(lives))
        help_ = SPAWN
    elif not caught:
        help_ = msg("Does turtle1 drive to a turtle, and is that killed then?")
    share = max(0, len(caught) - far) / least
    return Finding(share, text, help_, tuple(map(_seen, caught[-1:])))


@checks()
def near(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """None is killed from afar.

    Each turtle that is killed is so when turtle1 is within {catch_m} m of it. What counts is their
    share, beyond a half.
    """
    return _worst(_near(_lives(trace), tolerances) for trace in _traces(recordings))


def _near(lives: list[Life], tolerances: Tolerances) -> Finding:
    killed = _prey(lives, tolerances)
    if not killed:
        return Finding(0, msg("No turtle was killed."), msg("Who calls /kill, and when?"))
    far = [each for each in killed if each.way_m > tolerances["catch_m"]]
    if not far:
        return Finding(1, msg("turtle1 was near each turtle that was killed."))
    first = far[0]
    text = msg("{n} of {all} turtles were killed from afar: turtle1 was {way:.2f} m from {name}.",
               n=len(far), all=len(killed), way=first.way_m, name=first.name)  # fmt: skip
    help_ = msg("Kill a turtle only when turtle1 says that it is there.")
    share = max(0, 1 - 2 * len(far) / len(killed))
    return Finding(share, text, help_, (_seen(first),))


def _traces(recordings: Recordings) -> Iterator[TurtleTrace]:
    return (TurtleTrace.of(recording.trace) for recording in recordings)


def _worst(findings: Iterable[Finding]) -> Finding:
    """Return the worst of several runs, with its evidence in that run."""
    run, worst = min(enumerate(findings), key=lambda each: each[1].share)
    return replace(worst, evidence=tuple(replace(each, run=run) for each in worst.evidence))


def _seen(life: Life) -> Evidence:
    note: Message = msg("{name} was killed, turtle1 was {way:.2f} m away",
                        name=life.name, way=life.way_m)  # fmt: skip
    seen = Evidence(life.last * STEP_S, note, tick=life.last)
    is_place = math.isfinite(life.x) and math.isfinite(life.y)
    return replace(seen, x=life.x, y=life.y) if is_place else seen


def _prey(lives: list[Life], tolerances: Tolerances) -> list[Life]:
    """Return those that were killed, and for which turtle1 had to drive."""
    born_m, catch_m = tolerances["born_m"], tolerances["catch_m"]
    is_spread = _spread(lives) >= tolerances["spread_m"]
    killed = [life for life in lives if life.is_killed and is_spread]
    return [life for life in killed if life.born_m >= born_m and life.ahead_m > catch_m]


def _spread(lives: list[Life]) -> float:
    """The smaller standard deviation of the places along x and y [m]; inf of few."""
    places = [(life.x, life.y) for life in lives]
    return float(np.std(places, axis=0).min()) if len(lives) > FEW else math.inf


def _lives(trace: TurtleTrace) -> list[Life]:
    """The turtles other than turtle1, in the order of their spawning; one may live twice."""
    hunter, lives = trace.trajectory(), list[Life]()
    kills = {(event.name, event.tick) for event in trace.events if isinstance(event, Kill)}
    for name, way in trace.trajectories.items():
        gaps = np.flatnonzero(np.diff(way.ticks) > 1) + 1
        for part in np.split(np.arange(len(way)), gaps) if name != FIRST_TURTLE else ():
            if not len(part):
                continue
            first, last = part[0], part[-1]
            tick = int(way.ticks[last])
            born_m, way_m = (_apart(way, row, hunter) for row in (first, last))
            ways_m = born_m, way_m, _apart(way, first, hunter, len(part) * STEP_S)
            is_killed = tick < trace.ticks and any((name, tick + n) in kills for n in range(3))
            place = (float(way.x[last]), float(way.y[last]))
            lives.append(Life(name, int(way.ticks[first]), tick, *place, *ways_m, is_killed))
    return sorted(lives, key=lambda life: life.first)


def _apart(way: Trajectory, row: int, hunter: Trajectory, ahead_s: float = 0) -> float:
    """How near the hunter comes if it drives on so long as it does [m]; inf where there is none."""
    at = int(np.searchsorted(hunter.ticks, way.ticks[row]))
    if at == len(hunter) or hunter.ticks[at] != way.ticks[row]:
        return math.inf
    headings = hunter.theta[at] + hunter.angular[at] * np.arange(0, ahead_s, STEP_S)
    steps = hunter.linear[at] * STEP_S * np.array([np.cos(headings), np.sin(headings)])
    ways = np.cumsum(np.c_[[hunter.x[at] - way.x[row], hunter.y[at] - way.y[row]], steps], axis=1)
    return float(np.fmin.reduce(np.hypot(*ways), initial=math.inf))


def _waits(trace: TurtleTrace, lives: list[Life], most: int) -> list[tuple[float, float]]:
    """The waits for a turtle: since when, and how long [s]; only while fewer than `most` lived."""
    births = sorted(life.first for life in lives)
    deaths = sorted(life.last for life in lives if life.is_killed)
    ends = [*births, trace.ticks] if births[-1] < trace.ticks else births
    waits, since = list[tuple[float, float]](), 0
    for number, end in enumerate(ends):
        alive = number - int(np.searchsorted(deaths, since, side="right"))
        begin = since
        if alive >= most:  # until one dies
            later = deaths[int(np.searchsorted(deaths, since, side="right")) :][: alive - most + 1]
            begin = later[-1] if len(later) == alive - most + 1 else end
        waits.append((begin * STEP_S, max(0, end - begin) * STEP_S))
        since = end
    return waits
