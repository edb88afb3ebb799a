"""Verdicts that the nominal run alone decides, while the varied ones still go."""

from __future__ import annotations

from collections.abc import Mapping

from grader.errors import CheckFailed
from grader.exercise.check import Checks, Tolerances, answers, judge_one
from grader.exercise.verdict import Verdict
from grader.recording.recording import NominalAlone, NotOver, Recording


def judge_nominal(
    nominal: Recording, checks: Checks, points: Mapping[str, float], tolerances: Tolerances
) -> list[Verdict]:
    """Run the checks of `grader.exercise.check.judge` as far as one run lets them come.

    A check has a verdict here if it looks at the nominal run alone, and so do all that it depends
    on; all others are left out. One that fails itself is left out as well: who judges all runs is
    told of it.
    """
    answered = answers(NominalAlone(nominal), checks, points, tolerances)
    verdicts: dict[str, Verdict] = {}
    waiting: set[str] = set()
    for check in checks:
        if check.name not in points:
            continue
        if not waiting.isdisjoint(check.depends_on):
            waiting.add(check.name)
            continue
        try:
            verdicts[check.name] = judge_one(check, float(points[check.name]), answered, verdicts)
        except (NotOver, CheckFailed):
            waiting.add(check.name)
    return [verdicts[name] for name in points if name in verdicts]
