"""The check that costs most, as a diagnosis: where no run shows a cause by itself."""

from __future__ import annotations

from collections.abc import Sequence

from grader.diagnosis.diagnosis import CHECK, Diagnosis
from grader.exercise.verdict import Verdict
from grader.language.phrase import say
from grader.text import one_line


def costliest(verdicts: Sequence[Verdict]) -> Diagnosis | None:
    """The finding of the check that costs most, with those that wait for it."""
    failed = [verdict for verdict in verdicts if verdict.status == "failed"]
    failed = failed or [verdict for verdict in verdicts if not verdict.passed]
    if not failed:
        return None
    worst = max(failed, key=lambda verdict: _cost(verdict, verdicts))  # the first of equals
    first = worst.evidence[0] if worst.evidence else None
    return Diagnosis(
        CHECK,
        one_line(worst.rationale) or say("{title}: not as asked for.", title=worst.title),
        one_line(worst.help),
        run=first.run if first is not None else 0,
        time_s=first.time_s if first is not None else None,
        check=worst.check,
    )


def _cost(failed: Verdict, verdicts: Sequence[Verdict]) -> float:
    """What it costs, and all that is not judged because of it [points]."""
    lost = {failed.check: failed.max_score - failed.score}
    for _ in verdicts:  # one that waits may be waited for
        for verdict in verdicts:
            if verdict.status == "not_judged" and not lost.keys().isdisjoint(verdict.depends_on):
                lost.setdefault(verdict.check, verdict.max_score)
    return sum(lost.values())
