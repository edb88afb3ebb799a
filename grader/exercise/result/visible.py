"""A result as its student sees it: what an exercise's `visible` hides is nowhere in it.

What is shown depends on nothing that is hidden: whatever came of a hidden check, the same is shown.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final, Literal

from grader.exercise.result.diagnosis import Diagnosis, costliest
from grader.exercise.result.result import NotShown, Result
from grader.exercise.verdict import Verdict, Visible
from grader.text.message import NOTHING, msg

#: In place of what was found, where only the points are shown.
_NO_FINDING: Final = {
    "passed": msg("“{title}” passed. What was found is not shown: only its points are."),
    "failed": msg(
        "“{title}” did not pass in full. What was found is not shown: only its points are."
    ),
    "not_judged": msg(
        "“{title}” was not judged. What was found is not shown: only its points are."
    ),
}
#: The reader: a student, a student when the exercise is over, a teacher.
View = Literal["student", "after_due", "whole"]


def is_hidden(visible: Visible, after_due: bool = False) -> bool:
    """Whether students see nothing of a check."""
    return visible == "never" or (visible == "after_due" and not after_due)


def student_view(result: Result, after_due: bool = False) -> Result:
    """Return a result without what is hidden from its student; the result itself if nothing is.

    Its scores are those of the verdicts that are left, so that nothing can be concluded from a
    difference; `not_shown` counts the others.

    Args:
        after_due: whether the exercise is over for everybody.
    """
    hidden = [v for v in result.verdicts if is_hidden(v.visible, after_due)]
    if not hidden and all(verdict.visible != "points_only" for verdict in result.verdicts):
        return result
    names = {verdict.check for verdict in hidden}
    shown = tuple(_shown(verdict, names) for verdict in result.verdicts if verdict not in hidden)
    return replace(
        result,
        score=round(sum(verdict.score for verdict in shown), 2),
        max_score=round(sum(verdict.max_score for verdict in shown), 2),
        verdicts=shown,
        diagnosis=_diagnosis(result.diagnosis, shown),
        not_shown=_counted(result.not_shown, hidden),
    )


def _shown(verdict: Verdict, hidden: set[str]) -> Verdict:
    """Return a verdict without what is hidden of it, or of others."""
    if verdict.visible == "points_only":
        rationale = _NO_FINDING[verdict.status].given(title=verdict.title or verdict.check)
        verdict = replace(verdict, rationale=rationale, help=NOTHING, evidence=(), expected=())
    if hidden.isdisjoint(verdict.depends_on):
        return verdict
    left = tuple(name for name in verdict.depends_on if name not in hidden)
    verdict = replace(verdict, depends_on=left)
    if verdict.status != "not_judged":
        return verdict
    # No exercise that can be loaded leads here, but a result file may have been changed.
    return replace(verdict, rationale=msg("Not judged: it waits for others."), help=NOTHING)


def _diagnosis(found: Diagnosis | None, shown: Sequence[Verdict]) -> Diagnosis | None:
    """Return the cause of the points that are lost in the checks that are shown.

    What a run shows by itself the student has seen; the finding of a check is chosen anew, for the
    points that it costs may be hidden ones.
    """
    if found is None or all(verdict.passed for verdict in shown):
        return None
    if not found.check:
        return found
    telling = [v for v in shown if v.visible != "points_only" or v.status != "failed"]
    return costliest(telling if any(v.status == "failed" for v in telling) else shown)


def _counted(before: NotShown | None, hidden: Sequence[Verdict]) -> NotShown | None:
    """Count what is left out, with what was left out before."""
    if not hidden:
        return before
    until_due = sum(verdict.visible == "after_due" for verdict in hidden)
    worth = sum(verdict.max_score for verdict in hidden)
    before = before or NotShown(0, 0.0)
    return NotShown(
        before.checks + len(hidden),
        round(before.max_score + worth, 2),
        before.until_due + until_due,
    )
