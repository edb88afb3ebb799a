"""The checks of the follower: how far it is from the leader, and on which side."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from grader.exercise.check import Checks, Tolerances
from grader.exercise.verdict import Evidence, Finding
from grader.recording.recording import Recording, Recordings
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from grader.text.message import msg
from grader.text.strings import without_controls
from turtlesim_py.world.arena import TICK_NS
from turtlesim_py.world.trajectory import Trajectory

checks = Checks()
STEP_S = TICK_NS / 1e9
FOLLOWER = "turtle2"


class Following(NamedTuple):
    """The ticks of a run from some moment on; a tick without one of both is far away.

    Attributes:
        ticks: int64 (n,).
        x, y: where the follower was [m], float64 (n,).
        away_m: how far it was from the leader [m], float64 (n,).
        is_behind: whether it was behind the leader, bool (n,).
    """

    ticks: NDArray[np.int64]
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    away_m: NDArray[np.float64]
    is_behind: NDArray[np.bool_]


@checks(parrot="it follows nobody yet")
def spawned(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """turtle2 is there.

    It was spawned after {from_s} s at the latest.
    """
    trace = TurtleTrace.of(recordings.nominal.trace)
    way = trace.trajectory(FOLLOWER)
    if others := [name for name in trace.trajectories if name != FIRST_TURTLE and not len(way)]:
        text = msg("There is no turtle2, but {name}.", name=without_controls(others[0][:100], "?"))
        return Finding(0, text, msg("Spawn it with the name turtle2."))
    if not len(way):
        help_ = msg("A client of /spawn, with the name turtle2: is its request sent?")
        return Finding(0, msg("There is no turtle2."), help_)
    at_s = int(way.ticks[0]) * STEP_S
    text = msg("turtle2 was there after {at:.1f} s.", at=at_s)
    if at_s > tolerances["from_s"]:
        return Finding(0, text, msg("Spawn it when the node begins."))
    return Finding(1, text)


@checks(after=("spawned",))
def distance(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """It keeps its distance.

    From {from_s} s on turtle2 is {nearest_m} to {farthest_m} m from turtle1, for {enough%} of the
    time; less of it is a part of the points, less than {chance%} none.
    """
    return _kept(recordings.nominal, 0, tolerances)


@checks(after=("spawned",))
def behind(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """It stays behind.

    For {enough_behind%} of that time it is at this distance, and behind turtle1; less of it is a
    part of the points, less than {chance%} none.
    """
    found = _following(recordings.nominal, tolerances["from_s"])
    is_right = _is_near(found, tolerances) & found.is_behind
    share = float(is_right.mean()) if len(is_right) else 0.0
    text = msg("turtle2 was behind turtle1 for {share:.0%} of the time.", share=share)
    if share >= tolerances["enough_behind"]:
        return Finding(1, text)
    help_ = msg("Drive to a place behind turtle1: its x less a metre times cos(theta).")
    return Finding(_part(share, tolerances["enough_behind"], tolerances), text, help_)


@checks(after=("spawned",))
def elsewhere(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """It follows elsewhere, too.

    The same where turtle1 begins elsewhere and goes at another pace; the worst run counts.
    """
    found = [_kept(each, n, tolerances) for n, each in enumerate(recordings.varied, 1)]
    return min(found, key=lambda finding: finding.share)


def _kept(recording: Recording, run: int, tolerances: Tolerances) -> Finding:
    found = _following(recording, tolerances["from_s"])
    is_near = _is_near(found, tolerances)
    share, enough = (float(is_near.mean()) if len(is_near) else 0.0), tolerances["enough"]
    text = msg("turtle2 kept its distance for {share:.0%} of the time.", share=share)
    if share >= enough:
        return Finding(1, text)
    if not len(is_near):
        text = msg("The run ended before {at:g} s.", at=tolerances["from_s"])
        return Finding(0, text, msg("Does the node go on?"))
    at = int(np.flatnonzero(~is_near)[0])
    away = float(found.away_m[at])
    note = msg("here it is {away:.2f} m away", away=away)
    tick = int(found.ticks[at])
    seen = Evidence(tick * STEP_S, msg("here it is not there"), run=run, tick=tick)
    if np.isfinite(away):
        seen = replace(seen, note=note, x=float(found.x[at]), y=float(found.y[at]))
    help_ = msg("Does it read where turtle1 is, again and again, and drive there fast enough?")
    if float((found.away_m < tolerances["nearest_m"]).mean()) > (1 - share) / 2:
        help_ = msg("It comes too near: does it slow down, and keep a metre behind?")
    return Finding(_part(share, enough, tolerances), text, help_, (seen,))


def _part(share: float, enough: float, tolerances: Tolerances) -> float:
    return share / enough if share >= tolerances["chance"] else 0.0


def _is_near(found: Following, tolerances: Tolerances) -> NDArray[np.bool_]:
    low, high = float(tolerances["nearest_m"]), float(tolerances["farthest_m"])
    return (found.away_m >= low) & (found.away_m <= high)


def _following(recording: Recording, from_s: float) -> Following:
    trace = TurtleTrace.of(recording.trace)
    ticks = np.arange(1, trace.ticks + 1)
    ticks = ticks[ticks * STEP_S >= from_s]
    (x, y, _), (lead_x, lead_y, theta) = (
        _at(trace.trajectory(name), ticks) for name in (FOLLOWER, FIRST_TURTLE)
    )
    with np.errstate(all="ignore"):
        east, north = x - lead_x, y - lead_y
        away = np.hypot(east, north)
        ahead = east * np.cos(theta) + north * np.sin(theta)
    return Following(ticks, x, y, np.where(np.isfinite(away), away, np.inf), ahead < 0)


def _at(way: Trajectory, ticks: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return x, y and theta at each of these ticks; NaN where there was no such turtle."""
    rows = np.searchsorted(way.ticks, ticks)
    there = rows < len(way)
    there[there] = way.ticks[rows[there]] == ticks[there]
    found = np.full((3, len(ticks)), np.nan)
    found[:, there] = [each[rows[there]] for each in (way.x, way.y, way.theta)]
    return found
