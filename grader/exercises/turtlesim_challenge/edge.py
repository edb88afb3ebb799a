"""Judges whether the turtle stops near an edge, wherever it starts: all runs together."""

from __future__ import annotations

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Finding
from grader.exercises.turtlesim_challenge.path import Path
from grader.exercises.turtlesim_challenge.stops import (
    WALL_NAMES,
    Stop,
    has_stop_command_at,
    judge_stop,
)
from grader.recording.recording import Recordings
from grader.text.message import Message, chained, joined, msg
from turtlesim_py.world.turtle import TICK_S

SOON_S = 5.0
#: Stop commands this near to one moment, wherever the run started, come from counting [ticks].
SAME_MOMENT_TICKS = 2

_BY_THE_POSE = msg(
    "The stop must depend on the pose, not on the time or on how often something was done."
)


def judge_edge(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """Return the worst of all runs; those in which the time was up too early do not count."""
    first = judge_stop(Path(recordings.nominal), tolerances)
    if first.kind not in ("stopped", "halfway", "late", "wall"):
        return first.finding
    stops = [first]
    for number, recording in enumerate(recordings.varied, start=1):
        stops.append(judge_stop(Path(recording, number), tolerances))
    if first.kind == "wall":
        return _one_wall_only(stops) or first.finding
    telling = [stop for stop in stops if stop.kind != "late"]
    if not telling:
        return first.finding
    worst = min(telling, key=lambda stop: stop.finding.share)
    if worst.finding.share >= 1:
        return Finding(1, _all_right(stops), evidence=telling[0].finding.evidence)
    if worst is first or (first.kind == "halfway" and worst.finding.share > 0):
        return worst.finding
    return _not_elsewhere(stops, worst)


def _all_right(stops: list[Stop]) -> Message:
    late = [number for number, stop in enumerate(stops) if stop.kind == "late"]
    ended = next(stop for stop in stops if stop.kind != "late")
    if not late and len(stops) > 1:
        return msg(
            "It stopped by a command, {gap_m:.2f} m from the wall, and in the varied run too.",
            "It stopped by a command, {gap_m:.2f} m from the wall, and in the {n} varied runs too.",
            n=len(stops) - 1,
            gap_m=ended.gap_m,
        )
    if not late:
        return ended.finding.rationale
    more = msg(
        "In {which} the time, {seconds:.0f} s, was up before it came to a stop.",
        which=_which_run(late[0]),
        seconds=stops[late[0]].path.recording.run.simulated_s,
    )
    return joined([ended.finding.rationale, more], " ")


def _which_run(number: int) -> Message:
    return msg("run {number}", number=number) if number else msg("the run from the centre")


def _not_elsewhere(stops: list[Stop], worst: Stop) -> Finding:
    """Judge a turtle that stops when it starts from the centre, and not elsewhere."""
    here = stops[0]
    lasts_long = here.path.stop_tick * TICK_S > SOON_S  # else all moments are the same
    if (
        here.kind == "stopped"
        and lasts_long
        and all(
            has_stop_command_at(stop.path, here.path.stop_tick, SAME_MOMENT_TICKS)
            for stop in stops[1:]
        )
    ):
        text = msg(
            "From the centre it stopped by a command, {gap_m:.2f} m from the wall, but {run} it "
            "was told to stop at the same moment, at {time_s:.1f} s, wherever it was: {seen}",
            gap_m=here.gap_m,
            run=in_run(worst.path),
            time_s=here.path.stop_tick * TICK_S,
            seen=worst.finding.rationale,
        )
        return Finding(0, text, _BY_THE_POSE, worst.finding.evidence)
    only = _one_wall_only(stops)
    if only is not None:
        return only
    seen = worst.finding.rationale
    if worst.finding.help == here.finding.help and worst.kind == "other":  # one cause, named once
        seen = msg("it stood {gap_m:.2f} m from the nearest wall.", gap_m=worst.gap_m)
    return Finding(
        worst.finding.share,
        _but_elsewhere(here, worst.path, seen),
        _BY_THE_POSE if worst.kind == "far" else worst.finding.help,
        worst.finding.evidence,
    )


def in_run(path: Path) -> Message:
    """Name a varied run, with what differs in it: 'in run 1 (from (4.32, 5.61))'."""
    start = path.recording.start
    what = start.words if start is not None else msg("from the centre")
    return msg("in run {run} ({what})", run=path.number, what=what)


def _but_elsewhere(here: Stop, path: Path, seen: Message) -> Message:
    if here.kind == "stopped":
        return msg(
            "From the centre it stopped by a command, {gap_m:.2f} m from the wall, but not {run}: "
            "{seen}",
            gap_m=here.gap_m,
            run=in_run(path),
            seen=seen,
        )
    text = msg("{run!u}: {seen}", run=in_run(path), seen=seen)
    return joined([here.seen, text], " ") if here.kind == "halfway" else text


def _one_wall_only(stops: list[Stop]) -> Finding | None:
    """Judge a turtle that stops at some walls and runs into others; None where it does not."""
    at = sorted({stop.wall for stop in stops if stop.kind in ("stopped", "halfway")})
    into = [stop for stop in stops if stop.kind == "wall" and stop.wall not in at]
    touched = [stop for stop in stops if stop.kind == "wall"]
    if not at or not into or len(into) < len(touched):
        return None
    worst = into[0]
    wall = WALL_NAMES[worst.wall]
    return Finding(
        0,
        msg(
            "It stopped at the {walls} wall, but not at the {wall} one. In {which}: {seen}",
            "It stopped at the {walls} walls, but not at the {wall} one. In {which}: {seen}",
            n=len(at),
            walls=chained([WALL_NAMES[name] for name in at]),
            wall=wall,
            which=_which_run(worst.path.number),
            seen=worst.finding.rationale,
        ),
        msg(
            "Is the {wall} wall watched, or is its limit too near (x and y never go below 0 or "
            "above {size})? There are four: x and y each have a smallest and a largest value.",
            wall=wall,
            size=f"{worst.path.size_m:.2f}",
        ),
        worst.finding.evidence,
    )
