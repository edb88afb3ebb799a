"""The challenge's verdicts on behaviour that is driven through the real world, without ROS."""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.exercise.verdict import Verdict
from grader.recording.recording import Recording, Recordings
from grader.recording.subject import Start
from grader.testing import drive

EXERCISE = load_exercise("turtlesim_challenge")
LIMIT = 11250  # ticks in 180 s


@lru_cache(16)
def driven(controller: Callable[[], Any], ticks: int, start: Start | None = None) -> Recording:
    return drive(controller(), ticks, start)


def verdicts(
    controller: Callable[[], Any],
    varied: bool = True,
    ticks: int = 4000,
    seed: int | None = None,
    **tolerances: Any,
) -> dict[str, Verdict]:
    """Return the verdicts on what a call of `controller` makes, by the names of the checks."""
    starts = EXERCISE.starts(seed) if varied else []
    runs = tuple(driven(controller, ticks, start) for start in starts)
    recordings = Recordings(driven(controller, ticks), runs)
    tolerances = {**EXERCISE.tolerances, **tolerances}
    found = judge(recordings, EXERCISE.checks, EXERCISE.points, tolerances)
    return {verdict.check: verdict for verdict in found}


def total(found: dict[str, Verdict]) -> float:
    return sum(verdict.score for verdict in found.values())


def lost(found: dict[str, Verdict]) -> set[str]:
    return {name for name, verdict in found.items() if verdict.status != "passed"}


def expect_said(words: str, verdict: Verdict) -> None:
    """Check that a verdict says some words and, behind each " .* ", some more."""
    text = f"{verdict.rationale!s} {verdict.help!s}"
    for part in words.split(" .* "):
        assert part in text, text
        text = text.partition(part)[2]
