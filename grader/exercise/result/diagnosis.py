"""A diagnosis: one cause, for the first line of a report; at worst the costliest check's."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from grader.exercise.exercise import Exercise
from grader.exercise.verdict import Verdict
from grader.recording.observations import LintFinding, RanFile, SourceLine
from grader.recording.recording import Recordings
from grader.system import extensions
from grader.system.strict_json import SPARSE
from grader.text.message import Message, msg
from grader.text.strings import one_line

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


class Diagnoser(ABC):
    """Finds why points were lost; an entry point of `grader.diagnoses`.

    What it finds in the source is kept with the recording, so that the recording alone, judged
    again, has the same first line.
    """

    @abstractmethod
    def lint(self, root: Path, files: Iterable[Path]) -> tuple[LintFinding, ...]:
        """Return what the source shows, in the confined process that reads a submission.

        Args:
            root: the submission's folder.
            files: the Python files below it that its programs import.
        """

    @abstractmethod
    def in_run(
        self, lint_findings: Sequence[LintFinding], ran: Sequence[RanFile], is_over: bool
    ) -> Iterable[LintFinding]:
        """Return the findings to keep with a run.

        Args:
            lint_findings: those of `lint`, and the lines that an exception came to.
            ran: the lines that have run.
            is_over: whether no line can run any more.
        """

    @abstractmethod
    def diagnose(
        self, exercise: Exercise, recordings: Recordings, verdicts: Sequence[Verdict]
    ) -> Diagnosis | None:
        """Return the cause of lost points; None where none were lost, or none is known."""


def diagnose(
    exercise: Exercise, recordings: Recordings, verdicts: Sequence[Verdict]
) -> Diagnosis | None:
    """Return the first diagnosis of the installed diagnosers, else the costliest check's."""
    for diagnoser in extensions.load_all(extensions.DIAGNOSES):
        diagnosis: Diagnosis | None = diagnoser.diagnose(exercise, recordings, verdicts)
        if diagnosis is not None:
            return diagnosis
    return costliest(verdicts)


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
        one_line(worst.rationale) or msg("{title}: not as asked for.", title=worst.title),
        one_line(worst.help),
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
