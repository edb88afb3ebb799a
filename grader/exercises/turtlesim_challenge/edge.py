"""Judges whether the turtle stops near an edge, wherever it starts: all runs together."""

from __future__ import annotations

from dataclasses import replace

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Finding
from grader.exercises.turtlesim_challenge.path import Path
from grader.exercises.turtlesim_challenge.stops import (
    WALL_NAMES,
    Stop,
    has_stop_command_at,
    judge_stop,
    passed_by_m,
)
from grader.message import Message, chained, joined, msg, msg_many
from grader.recording.recording import Recordings
from turtlesim_py.world.turtle import TICK_S

#: Stop commands this near to one moment, wherever the run started, come from counting [ticks].
SAME_MOMENT_TICKS = 32


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
        stops.append(_judge_varied(Path(recording, number), tolerances))
    if first.kind == "wall":
        return _one_wall_only(stops) or first.finding
    telling = [stop for stop in stops if stop.kind != "late"]
    if not telling:
        return first.finding
    worst = min(telling, key=lambda stop: stop.finding.share)
    if worst.finding.share >= 1 and _all_at_one_moment(stops):
        return Finding(
            0,
            msg(
                "It stopped by a command, {gap_m:.2f} m from the wall, but at the same moment, "
                "after {time_s:.2f} s, from wherever it started: that it was near a wall each "
                "time is chance.",
                gap_m=first.gap_m,
                time_s=first.path.stop_tick * TICK_S,
            ),
            _BY_THE_POSE,
            first.finding.evidence,
        )
    if worst.finding.share >= 1:
        return Finding(1, _all_right(stops), evidence=telling[0].finding.evidence)
    if worst is first or (first.kind == "halfway" and worst.finding.share > 0):
        return worst.finding
    return _not_elsewhere(stops, worst)


def _all_at_one_moment(stops: list[Stop]) -> bool:
    """Whether several runs from elsewhere lasted as long as the first, to the tick."""
    first, *others = [stop.path.stop_tick for stop in stops]
    return len(others) > 1 and all(abs(tick - first) <= 1 for tick in others)


def _judge_varied(path: Path, tolerances: Tolerances) -> Stop:
    stop = judge_stop(path, tolerances)
    if stop.kind != "stopped":
        return stop
    passed_by = passed_by_m(stop)
    if passed_by <= tolerances["passed_by_m"]:
        return stop
    seen = msg(
        "the turtle stopped {gap_m:.2f} m from the {wall} wall, but had been nearer to that "
        "wall by {passed_by_m:.2f} m before, and had driven on.",
        gap_m=stop.gap_m,
        wall=WALL_NAMES[stop.wall],
        passed_by_m=passed_by,
    )
    finding = Finding(0, seen, evidence=stop.finding.evidence)
    return replace(stop, kind="far", finding=finding)


def _all_right(stops: list[Stop]) -> Message:
    late = [number for number, stop in enumerate(stops) if stop.kind == "late"]
    ended = next(stop for stop in stops if stop.kind != "late")
    if not late and len(stops) > 1:
        return msg_many(
            "It stopped by a command, {gap_m:.2f} m from the wall, and in the run that starts "
            "elsewhere too.",
            "It stopped by a command, {gap_m:.2f} m from the wall, and in the {n} runs that start "
            "elsewhere too.",
            len(stops) - 1,
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
    if worst.kind == "void":
        return _not_where_it_was_put(here, worst)
    lasts_long = here.path.stop_tick > 10 * SAME_MOMENT_TICKS  # else all moments are the same
    if (
        here.kind == "stopped"
        and lasts_long
        and has_stop_command_at(worst.path, here.path.stop_tick, SAME_MOMENT_TICKS)
    ):
        text = msg(
            "From the centre it stopped by a command, {gap_m:.2f} m from the wall, but when it "
            "started elsewhere (run {run}) it was told to stop at the same moment, at "
            "{time_s:.1f} s, wherever it was: {seen}",
            gap_m=here.gap_m,
            run=worst.path.number,
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
        _but_elsewhere(here, worst.path.number, seen),
        _BY_THE_POSE if worst.kind == "far" else worst.finding.help,
        worst.finding.evidence,
    )


def _not_where_it_was_put(here: Stop, worst: Stop) -> Finding:
    """Judge a run from elsewhere in which the node moved the turtle before it drove."""
    seen = started_elsewhere(worst.path.number, worst.finding.rationale)
    lead = [here.seen] if here.kind == "halfway" else []
    if here.kind == "stopped":
        lead = [
            msg(
                "From the centre it stopped by a command, {gap_m:.2f} m from the wall.",
                gap_m=here.gap_m,
            )
        ]
    return replace(worst.finding, rationale=joined([*lead, seen], " "))


def started_elsewhere(run: int, seen: Message) -> Message:
    """Say what was found in a run that starts elsewhere."""
    return msg("The turtle started elsewhere (run {run}). {seen}", run=run, seen=seen)


def _but_elsewhere(here: Stop, run: int, seen: Message) -> Message:
    if here.kind == "stopped":
        return msg(
            "From the centre it stopped by a command, {gap_m:.2f} m from the wall, but not when "
            "it started elsewhere (run {run}): {seen}",
            gap_m=here.gap_m,
            run=run,
            seen=seen,
        )
    text = msg("When it started elsewhere (run {run}): {seen}", run=run, seen=seen)
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
        msg_many(
            "It stopped at the {walls} wall, but not at the {wall} one. In {which}: {seen}",
            "It stopped at the {walls} walls, but not at the {wall} one. In {which}: {seen}",
            len(at),
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
