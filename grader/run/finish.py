"""How a run ended, and the recording that is made of it."""

from __future__ import annotations

from dataclasses import dataclass

from grader.recording.recording import Clock, Outcome, PublishedTopic, Recording, Run
from grader.run.plan import Plan
from grader.scenes.scene import Reason, Trace


@dataclass(frozen=True)
class Ending:
    """What the grader knows of a run beside its trace; see `grader.recording.recording.Run`."""

    time: Clock
    outcome: Outcome
    exit_code: int | None
    wall_s: float
    isolation: str
    output: str
    flags: tuple[str, ...] = ()


def outcome(reason: Reason, exit_code: int | None) -> Outcome:
    """How a run ended: what the simulator saw, and how the submission's process ended."""
    if exit_code is None:
        return "finished" if reason == "rest" else "time_limit"
    if exit_code < 0:
        return "killed"
    if exit_code > 0:
        return "crashed"
    return "finished" if reason == "rest" else "exited"


def record(
    plan: Plan, trace: Trace, topics: tuple[PublishedTopic, ...], ending: Ending
) -> Recording:
    """Everything about a run that is over."""
    return Recording(
        trace=trace,
        run=Run(
            time=ending.time,
            outcome=ending.outcome,
            exit_code=ending.exit_code,
            ticks=trace.ticks,
            simulated_s=trace.simulated_s,
            wall_s=round(ending.wall_s, 3),
            trace_sha256=trace.sha256(),
            isolation=ending.isolation,
            flags=(*ending.flags, *plan.flags),
            seed=plan.seed,
            interfaces=plan.interfaces,
        ),
        topics=topics,
        output=ending.output,
        start=plan.start,
        scene=plan.scene,
    )
