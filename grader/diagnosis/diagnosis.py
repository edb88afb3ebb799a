"""A diagnosis: one cause, for the first line of a report; at worst the costliest check's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from grader.exercise.verdict import Verdict
from grader.message import Message, msg
from grader.recording.observations import SourceLine
from grader.strict_json import SPARSE
from grader.text import in_one_line

#: The key of a diagnosis that repeats the finding of a check.
CHECK = "check"


@dataclass(frozen=True)
class Diagnosis:
    """Why points were lost: the earliest cause that is sure.

    Attributes:
        key: the rule that found it, as 'crashed'; `CHECK` where a check did.
        cause: what was found and what was expected, in one line.
        help: what to do.
        run: in which run: 0 nominal, 1, 2, ... varied.
        time_s: when in it [s]; None where that is not known or does not matter.
        place: in the submission's own files; None where that is not known.
        check: the check that found it; '' for what a run shows by itself.
    """

    key: str
    cause: Message
    help: Message
    run: int = 0
    time_s: float | None = field(default=None, metadata=SPARSE)
    place: SourceLine | None = field(default=None, metadata=SPARSE)
    check: str = field(default="", metadata=SPARSE)

    @property
    def spoken(self) -> str:
        """Its cause and help in English, to look for words in."""
        return f"{self.cause!s} {self.help!s}"


def costliest(verdicts: Sequence[Verdict]) -> Diagnosis | None:
    """Make a diagnosis of the check that costs most, counting those that depend on it."""
    failed = [verdict for verdict in verdicts if verdict.status == "failed"]
    failed = failed or [verdict for verdict in verdicts if not verdict.passed]
    if not failed:
        return None
    worst = max(failed, key=lambda verdict: _cost(verdict, verdicts))  # the first of equals
    first = worst.evidence[0] if worst.evidence else None
    return Diagnosis(
        CHECK,
        in_one_line(worst.rationale) or msg("{title}: not as asked for.", title=worst.title),
        in_one_line(worst.help),
        run=first.run if first is not None else 0,
        time_s=first.time_s if first is not None else None,
        check=worst.check,
    )


def _cost(failed: Verdict, verdicts: Sequence[Verdict]) -> float:
    """Return what a failed check costs, with all that is not judged because of it [points]."""
    lost = {failed.check: failed.max_score - failed.score}
    for _ in verdicts:  # one that waits may be waited for
        for verdict in verdicts:
            if verdict.status == "not_judged" and not lost.keys().isdisjoint(verdict.depends_on):
                lost.setdefault(verdict.check, verdict.max_score)
    return sum(lost.values())
