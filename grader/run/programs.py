"""The programs of a submission in a run: each in a confined process, with an account of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from grader.recording.observations import Observations
from grader.recording.recording import LONGEST_OUTPUT, Clock, Outcome, ProgramRun
from grader.run.evidence import EvidencePage
from grader.run.finish import Ending, ended
from grader.run.processes.started_process import SubmissionProcess
from grader.submission.program import Program
from grader.submission.start import Submission
from grader.text.message import Message
from grader.text.strings import plain


class RunningProgram(NamedTuple):
    """A program whose process was started.

    Attributes:
        submission: with its paths in the copy of that process.
    """

    program: Program
    submission: Submission
    process: SubmissionProcess
    account: EvidencePage

    def output(self) -> str:
        return self.submission.with_original_paths(self.process.output())


class ProgramEnd(NamedTuple):
    """How a program has ended.

    Attributes:
        at_s: when, by the clock of the run [s].
        has_failed: whether that is why something is missing.
    """

    outcome: Outcome
    exit_code: int | None
    at_s: float
    has_failed: bool


def blamed(ends: Sequence[ProgramEnd]) -> int:
    """Return which program a run's outcome is due to: the first that failed.

    Without one it is the first that still ran, else the first.
    """
    failed = [(end.at_s, number) for number, end in enumerate(ends) if end.has_failed]
    if failed:
        return min(failed)[1]
    return next((number for number, end in enumerate(ends) if end.exit_code is None), 0)


def observations_of(
    running: Sequence[RunningProgram], ends: Sequence[ProgramEnd], computes: Sequence[bool]
) -> Observations:
    """Return what is known of the program that a run's outcome is due to.

    Where none has failed, what they lack may be between them: then it is what is known of all, and
    first of one that has ended and never spun its nodes.

    Args:
        computes: of each, whether it would have gone on without waiting for anything.
    """

    def known_of(number: int) -> Observations:
        each, is_busy = running[number], computes[number]
        return each.account.observations(each.submission, ends[number].at_s, computes=is_busy)

    number = blamed(ends)
    if ends[number].has_failed:
        return known_of(number)
    known = [known_of(each) for each in range(len(running))]
    ended_deaf = (
        place
        for place, (end, each) in enumerate(zip(ends, known, strict=True))
        if end.exit_code == 0 and each.is_known and each.ends and each.spun_s is None
    )
    its = known.pop(next(ended_deaf, number))
    return its.joined(known)


def ending_of(
    clock: Clock,
    running: Sequence[RunningProgram],
    ends: Sequence[ProgramEnd],
    isolation: str,
    since_s: float,
    flags: tuple[Message, ...] = (),
) -> Ending:
    """Return the ending of a run that is over; of several programs each line says whose it is.

    Args:
        since_s: when the run began, on the machine's monotonic clock [s].
    """
    number, texts = blamed(ends), [each.output() for each in running]
    its, end = running[number], ends[number]
    made = ended(
        *(clock, its.submission, its.process, isolation, since_s),
        *(end.outcome, end.exit_code, flags),
    )
    programs = tuple(
        ProgramRun(
            *(each.program.name, each.program.package, each.program.executable),
            *(end.outcome, end.exit_code, plain(text)[-LONGEST_OUTPUT:]),
        )
        for each, end, text in zip(running, ends, texts, strict=True)
    )
    made = made._replace(run=replace(made.run, programs=programs))
    if len(running) == 1:
        return made
    lines = [
        f"[{each.program.name}] {line}\n"
        for each, text in zip(running, texts, strict=True)
        for line in text.splitlines()
    ]
    return made._replace(output="".join(lines))


def lost(clock: Clock, running: Sequence[RunningProgram], isolation: str, since_s: float) -> Ending:
    """Return the ending of a run whose simulator has died beside its programs; see `ending_of`."""
    ends = [ProgramEnd("killed", None, 0.0, has_failed=True) for _ in running]
    return ending_of(clock, running, ends, isolation, since_s)
