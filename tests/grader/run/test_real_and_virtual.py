"""Real time judges as virtual time does. Takes a minute of real time: TURTLESIM_COMPARE=1."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.grading import Runner, run_all
from grader.run import real_time, virtual_time
from grader.submission.opening import open_submission

SUBMISSIONS = Path(__file__).parents[2] / "submissions"
#: Those that do not hang on when discovery ends or on how threads race.
REPRODUCIBLE = (
    "quick_spiral",
    "styles/timer",
    "styles/spin_once_loop",
    "styles/rate_with_spin_thread",
)


def verdicts(name: str, run: Runner) -> dict[str, tuple[str, float]]:
    exercise = load_exercise("turtlesim_challenge")
    exercise = replace(exercise, varied=replace(exercise.varied, count=0))
    with open_submission(SUBMISSIONS / f"{name}.py") as submission:
        recordings = run_all(submission, exercise, run)
    found = judge(recordings, exercise.checks, exercise.points, exercise.tolerances)
    return {verdict.check: (verdict.status, verdict.score) for verdict in found}


@pytest.mark.timeout(300)
@pytest.mark.skipif(not os.environ.get("TURTLESIM_COMPARE"), reason="needs TURTLESIM_COMPARE=1")
def test_real_and_virtual_time_give_the_same_verdicts() -> None:
    with ThreadPoolExecutor(len(REPRODUCIBLE)) as pool:
        virtual = dict(
            zip(
                REPRODUCIBLE,
                pool.map(lambda name: verdicts(name, virtual_time.run), REPRODUCIBLE),
                strict=True,
            )
        )
        real = dict(
            zip(
                REPRODUCIBLE,
                pool.map(lambda name: verdicts(name, real_time.run), REPRODUCIBLE),
                strict=True,
            )
        )
    assert virtual == real
