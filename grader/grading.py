"""Grade a submission: the nominal run and the varied ones, each repeated once if we spoiled it."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Protocol

from grader.errors import GraderFailure
from grader.exercise.loading import Exercise, Limits
from grader.recording.recording import Recording, Recordings, Start
from grader.submission.opening import Submission

Progress = Callable[[float], None]


class Runner(Protocol):
    """Runs a submission once; see `grader.run.virtual_time` and `grader.run.real_time`."""

    def __call__(
        self,
        submission: Submission,
        limits: Limits,
        start: Start | None = None,
        progress: Progress | None = None,
    ) -> Recording:
        """Return what happened."""


def grade(
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
    starts = [None, *exercise.varied.starts(seed)]

    def run_from(start: Start | None) -> Recording:
        show = progress if start is None else None
        try:
            recording = run(submission, exercise.limits, start, show)
        except GraderFailure:
            recording = run(submission, exercise.limits, start, show)
            flags = (*recording.run.flags, "repeated, because the first try failed in the grader")
            recording = replace(recording, run=replace(recording.run, flags=flags))
        return recording

    with ThreadPoolExecutor(max_workers=min(len(starts), max(2, os.cpu_count() or 1))) as pool:
        nominal, *varied = pool.map(run_from, starts)
    if varied:
        used = exercise.varied.seed if seed is None else seed
        nominal = replace(nominal, run=replace(nominal.run, seed=used))
    return Recordings(nominal, tuple(varied))
