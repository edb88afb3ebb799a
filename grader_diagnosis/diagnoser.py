"""The diagnoser of first lines: an entry point of `grader.diagnoses`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from pathlib import Path

from grader import Exercise, Recordings, Verdict
from grader.exercise import Diagnoser, Diagnosis
from grader.recording.observations import LintFinding, RanFile
from grader_diagnosis.lint import lint, paths

#: So many calls that were not reached are kept.
MOST_UNREACHED = 20


class FirstLines(Diagnoser):
    """Applies the rules of this package."""

    def lint(self, root: Path, files: Iterable[Path]) -> tuple[LintFinding, ...]:
        return lint.lint(root, files)

    def in_run(
        self, lint_findings: Sequence[LintFinding], ran: Sequence[RanFile], is_over: bool
    ) -> Iterator[LintFinding]:
        yield from (each for each in lint_findings if each.kind != "step")
        if is_over:
            steps = (each for each in lint_findings if each.kind == "step")
            yield from islice(paths.unreached(steps, ran), MOST_UNREACHED)

    def diagnose(
        self, exercise: Exercise, recordings: Recordings, verdicts: Sequence[Verdict]
    ) -> Diagnosis | None:
        # here: a submission that is read waits for none of the rules
        from grader_diagnosis import diagnose

        return diagnose.diagnose(
            recordings, verdicts, exercise.peers_have, is_to_end=exercise.is_to_end
        )


FIRST_LINES = FirstLines()
