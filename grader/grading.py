"""Grade a submission: the nominal run and the varied ones, each repeated once if we spoiled it."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Protocol

from grader.errors import GraderFailure
from grader.exercise.loading import Exercise
from grader.recording.recording import Recording, Recordings
from grader.run.plan import Plan
from grader.submission.opening import Submission

Progress = Callable[[float], None]
REPEATED = "repeated, because the first try failed in the grader"


class Runner(Protocol):
    """Runs a submission once; see `grader.run.virtual_time` and `grader.run.real_time`."""

    def __call__(
        self, submission: Submission, plan: Plan, progress: Progress | None = None
    ) -> Recording:
        """Return what happened."""


def run_all(
    submission: Submission,
    exercise: Exercise,
    run: Runner,
    *,
    seed: int | None = None,
    progress: Progress | None = None,
) -> Recordings:
    """Run a submission from its usual start and, where the exercise asks for it, from elsewhere.

    Args:
        seed: chooses where the varied runs start; None takes the exercise's own.
        progress: called with the simulated seconds of the nominal run.

    Raises:
        GraderFailure: a run could not be made, twice.
    """
    starts = exercise.starts(seed)
    used = exercise.varied.seed if seed is None else seed
    nominal_plan = Plan(exercise.limits, scene=exercise.scene, seed=used if starts else None)
    plans = [nominal_plan, *(replace(nominal_plan, start=s, seed=None) for s in starts)]

    def run_twice_at_most(plan: Plan) -> Recording:
        show = progress if plan is nominal_plan else None
        try:
            return run(submission, plan, show)
        except GraderFailure:
            return run(submission, replace(plan, flags=(REPEATED,)), show)

    with ThreadPoolExecutor(max_workers=min(len(plans), max(2, os.cpu_count() or 1))) as pool:
        nominal, *varied = pool.map(run_twice_at_most, plans)
    return Recordings(nominal, tuple(varied))
