"""Whether the turtle stops near an edge, wherever it starts: all runs together."""

from __future__ import annotations

from dataclasses import replace

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Finding
from grader.exercises.turtlesim_challenge.path import Path
from grader.exercises.turtlesim_challenge.stops import (
    HALF_OF_IT,
    Stop,
    is_told_to_stop_at,
    judge_stop,
    passed_by_m,
)
from grader.recording.recording import Recordings
from turtlesim_py.world.turtle import TICK_S

#: Who is told to stop this near to the same moment, wherever it started, counts [ticks].
SAME_MOMENT_TICKS = 32


_BY_THE_POSE = (
    "The stop must depend on the pose, not on the time or on how often something was done."
)


def judge_edge(recordings: Recordings, tolerances: Tolerances) -> Finding:
    """The worst of all runs; those in which the time was up too early tell nothing."""
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
            f"It {first.finding.rationale}, but at the same moment, after "
            f"{first.path.stop_tick * TICK_S:.2f} s, from wherever it started: that it was near a "
            "wall each time is chance.",
            _BY_THE_POSE,
            first.finding.evidence,
        )
    if worst.finding.share >= 1:
        return Finding(1, _all_right(stops), evidence=telling[0].finding.evidence)
    if worst is first or (first.kind == "halfway" and worst.finding.share > 0):
        return worst.finding
    return _not_elsewhere(stops, worst)


def in_varied_runs_too(recordings: Recordings) -> str:
    """The end of a sentence: that it held in all of them."""
    count = len(recordings.varied)
    if not count:
        return ""
    which = "run that starts" if count == 1 else f"{count} runs that start"
    return f", and in the {which} elsewhere too"


def _all_at_one_moment(stops: list[Stop]) -> bool:
    """Whether several runs from elsewhere took as long as the first, to the tick."""
    first, *others = [stop.path.stop_tick for stop in stops]
    return len(others) > 1 and all(abs(tick - first) <= 1 for tick in others)


def _judge_varied(path: Path, tolerances: Tolerances) -> Stop:
    stop = judge_stop(path, tolerances)
    if stop.kind != "stopped":
        return stop
    passed_by = passed_by_m(stop)
    if passed_by <= tolerances["passed_by_m"]:
        return stop
    gap = float(path.wall_distance[path.last])
    finding = Finding(
        0,
        f"the turtle stopped {gap:.2f} m from the {stop.wall} wall, but had been nearer to that "
        f"wall by {passed_by:.2f} m before, and had driven on.",
        "",
        stop.finding.evidence,
    )
    return replace(stop, kind="far", finding=finding)


def _all_right(stops: list[Stop]) -> str:
    late = [number for number, stop in enumerate(stops) if stop.kind == "late"]
    told = next(stop.finding.rationale for stop in stops if stop.kind != "late")
    if not late:
        count = len(stops) - 1
        which = "run that starts" if count == 1 else f"{count} runs that start"
        return f"It {told}{f', and in the {which} elsewhere too' if count else ''}."
    seconds = f"{stops[late[0]].path.recording.run.simulated_s:.0f} s"
    which = "the run from the centre" if late[0] == 0 else f"run {late[0]}"
    return f"It {told}. In {which} the time, {seconds}, was up before it came to a stop."


def _not_elsewhere(stops: list[Stop], worst: Stop) -> Finding:
    """It stops when it starts from the centre, and not elsewhere."""
    nominal = stops[0].finding.rationale.removesuffix(".")
    before = "" if stops[0].kind == "late" else f"From the centre it {nominal}, but "
    if stops[0].kind == "halfway":
        before = f"{stops[0].finding.rationale.removesuffix(HALF_OF_IT)} "
    if worst.kind == "void":
        told = f"The turtle started elsewhere (run {worst.path.number}). {worst.finding.rationale}"
        lead = f"{before.removesuffix(', but ')}. " if stops[0].kind == "stopped" else before
        return replace(worst.finding, rationale=lead + told)
    here = stops[0]
    takes_long = here.path.stop_tick > 10 * SAME_MOMENT_TICKS  # else all moments are the same
    if (
        here.kind == "stopped"
        and takes_long
        and is_told_to_stop_at(worst.path, here.path.stop_tick, SAME_MOMENT_TICKS)
    ):
        return Finding(
            0,
            f"{before}when it started elsewhere (run {worst.path.number}) it was told to stop at "
            f"the same moment, at {here.path.stop_tick * TICK_S:.1f} s, wherever it was: "
            f"{worst.finding.rationale}",
            _BY_THE_POSE,
            worst.finding.evidence,
        )
    only = _one_wall_only(stops)
    if only is not None:
        return only
    lead = "not when it started" if here.kind == "stopped" else "When it started"
    told = worst.finding.rationale
    if worst.finding.help == here.finding.help and worst.kind == "other":  # one cause, told once
        gap = float(worst.path.wall_distance[worst.path.last])
        told = f"it stood {gap:.2f} m from the nearest wall."
    return Finding(
        worst.finding.share,
        f"{before}{lead} elsewhere (run {worst.path.number}): {told}",
        _BY_THE_POSE if worst.kind == "far" else worst.finding.help,
        worst.finding.evidence,
    )


def _one_wall_only(stops: list[Stop]) -> Finding | None:
    """It stops at some walls and runs into others."""
    at = sorted({stop.wall for stop in stops if stop.kind in ("stopped", "halfway")})
    into = [stop for stop in stops if stop.kind == "wall" and stop.wall not in at]
    touched = [stop for stop in stops if stop.kind == "wall"]
    if not at or not into or len(into) < len(touched):
        return None
    worst = into[0]
    where = "the run from the centre" if worst.path.number == 0 else f"run {worst.path.number}"
    walls = " and ".join(at)
    return Finding(
        0,
        f"It stopped at the {walls} wall{'s' if len(at) > 1 else ''}, but not at the {worst.wall} "
        f"one. In {where}: {worst.finding.rationale}",
        f"Is the {worst.wall} wall watched, or is its limit too near (x and y never go below 0 or "
        f"above {worst.path.size_m:.2f})? There are four: x and y each have a smallest and a "
        "largest value.",
        worst.finding.evidence,
    )
