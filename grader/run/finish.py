"""How a run and its programs ended, and the recording that is made of it.

A run whose simulator ended too early is repeated once, and then judged by what is there, nothing
(`recording_of_nothing`). A simulator that ends beside one submission, whenever that runs, ends
because of it: a submission that could make the grader fail at will would get "not the submission's
fault" for a wrong solution. If it ends before the submission has sent it anything, the grader has
failed.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from grader.errors import GraderFailure
from grader.recording.observations import Observations
from grader.recording.recording import (
    LONGEST_OUTPUT,
    Clock,
    Outcome,
    ProgramRun,
    PublishedTopic,
    Recording,
    Run,
)
from grader.recording.scene_and_cast import split
from grader.recording.subject import Trace, load_keeper, scene_at_work
from grader.run.evidence import EvidencePage
from grader.run.handover import Plan, keeper
from grader.run.limits import LIMITS, size
from grader.run.processes.started_process import SubmissionProcess
from grader.scenes.scene import Reason
from grader.submission.program import Program
from grader.submission.start import Submission
from grader.text.message import Message, msg
from grader.text.strings import plain, shown

NO_OBSERVATIONS = Observations()
#: Reasons of a scene's after which nothing more will come.
DONE: tuple[Reason, ...] = ("rest", "seen")
#: How much of a process's output is searched for why it ended [characters], [lines].
LAST_WORDS, MOST_LAST_LINES = 8192, 20
#: Exit codes that only a limit gives, SIGXCPU and SIGXFSZ, and what happened.
SIGNALS = {
    -24: msg("the node used more than {seconds} s of processor time", seconds=LIMITS.cpu_s),
    -25: msg(
        "the node wrote a file of more than {size}: a run may not", size=size(LIMITS.file_bytes)
    ),
}
_MEMORY = msg("one process may ask for {size} of memory", size=size(LIMITS.data_bytes))
_TASKS = msg("a run may have {number} processes and threads", number=LIMITS.tasks)
_FULL = msg("the folder for temporary files is full: there is little room in it")
_READ_ONLY = msg(
    "a run may write into its own folder, tempfile.gettempdir() and ~, and nowhere else"
)
#: The start of the last line of a program that was refused something -> the limit.
LAST_LINES = {
    "MemoryError": _MEMORY,
    "numpy._core._exceptions._ArrayMemoryError": _MEMORY,
    "numpy.core._exceptions._ArrayMemoryError": _MEMORY,
    "what():  std::bad_alloc": _MEMORY,
    "OSError: [Errno 12]": _MEMORY,
    "OSError: [Errno 24]": msg("a process may have {number} open files", number=LIMITS.open_files),
    "OSError: [Errno 30]": _READ_ONLY,
    "PermissionError: [Errno 13]": _READ_ONLY,
    "sqlite3.OperationalError: unable to open database file": _READ_ONLY,
    "OSError: [Errno 27]": msg("a file may have {size}", size=size(LIMITS.file_bytes)),
    "OSError: [Errno 28]": _FULL,
    "RuntimeError: can't start new thread": _TASKS,
    "BlockingIOError: [Errno 11]": msg("{limit}, if that was one more", limit=_TASKS),
}
#: For the result of a run that was lost twice, with how the simulator ended and its last line.
LOST_TWICE = msg(
    "the simulator ended while the node was running, in both tries, and nothing was recorded: "
    "{words}. What only drives cannot do that; if this node does nothing else, the grader is wrong"
)
LONGEST_WORDS = 200


class Ending(NamedTuple):
    """What the grader knows of a run beside its trace: its facts, and the printed output."""

    run: Run
    output: str = ""

    def with_flags(self, *flags: Message) -> Ending:
        """Return a copy with these remarks alone."""
        return self._replace(run=replace(self.run, flags=flags))


def ended(
    clock: Clock,
    submission: Submission,
    process: SubmissionProcess,
    isolation: str,
    since_s: float,
    how: Outcome,
    exit_code: int | None,
    flags: tuple[Message, ...] = (),
) -> Ending:
    """Return the ending of a run that is over.

    Args:
        process: the submission's.
        since_s: when it began, on the machine's monotonic clock [s].
    """
    output = submission.with_original_paths(process.output())
    struck = limits_struck(exit_code, output, process.excess)
    flags = (*(flag.map_texts(submission.with_original_paths) for flag in flags), *struck)
    wall_s = time.monotonic() - since_s
    run = Run(clock, how, exit_code, wall_s=wall_s, isolation=isolation, flags=flags)
    return Ending(run, output)


def outcome(reason: Reason, exit_code: int | None) -> Outcome:
    """Return the outcome of a run, from the simulator's reason and the submission's exit code."""
    if exit_code is None:
        return "finished" if reason in DONE else "time_limit"
    if exit_code < 0:
        return "killed"
    if exit_code > 0:
        return "crashed"
    return "finished" if reason in DONE else "exited"


# Several programs -----------------------------------------------------------------------------


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
        computes: whether it would have gone on without waiting for anything.
        remarks: on it, for the result.
    """

    outcome: Outcome
    exit_code: int | None
    at_s: float
    has_failed: bool
    computes: bool = False
    remarks: Sequence[Message] = ()


def blamed(ends: Sequence[ProgramEnd]) -> int:
    """Return which program a run's outcome is due to: the first that failed.

    Without one it is the first that still ran, else the first.
    """
    failed = [(end.at_s, number) for number, end in enumerate(ends) if end.has_failed]
    if failed:
        return min(failed)[1]
    return next((number for number, end in enumerate(ends) if end.exit_code is None), 0)


def observations_of(running: Sequence[RunningProgram], ends: Sequence[ProgramEnd]) -> Observations:
    """Return what is known of the program that a run's outcome is due to.

    Where none has failed, what they lack may be between them: then it is what is known of all, and
    first of one that has ended and never spun its nodes.
    """

    def known_of(its: RunningProgram, end: ProgramEnd) -> Observations:
        return its.account.observations(its.submission, end.at_s, computes=end.computes)

    number = blamed(ends)
    if ends[number].has_failed:
        return known_of(running[number], ends[number])
    known = list(map(known_of, running, ends))
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


# Recordings -----------------------------------------------------------------------------------


def not_run(plan: Plan, why: Message) -> Recording:
    """Return the recording of a run that was not started."""
    ending = Ending(Run("virtual", "not_run", flags=(why,)))
    return record(plan, _untouched(plan), (), ending)


class SimulatorLost(GraderFailure):
    """The simulator's process ended, or left nothing to be read, beside a submission's.

    Attributes:
        ending: what is known of the run.
    """

    def __init__(
        self,
        failure: GraderFailure,
        clock: Clock,
        running: Sequence[RunningProgram],
        isolation: str,
        since_s: float,
    ) -> None:
        super().__init__(failure.message)
        ends = [ProgramEnd("killed", None, 0.0, has_failed=True) for _ in running]
        self.ending = ending_of(clock, running, ends, isolation, since_s)


def recording_of_nothing(plan: Plan, lost: SimulatorLost) -> Recording:
    """Return the recording of a run that was lost twice: nothing has happened in it."""
    values = lost.message.values
    how, last_words = str(values.get("how", lost.message)), str(values.get("last", ""))
    # what stands in brackets is ROS's log, and has the submission's words in it
    lines = [line for line in last_words.splitlines() if line and not line.startswith("[")]
    words = [shown(text, LONGEST_WORDS) for text in (how.rstrip("."), *lines[-1:])]
    flags = (*lost.ending.run.flags, LOST_TWICE.given(words="; ".join(words)))
    return record(plan, _untouched(plan), (), lost.ending.with_flags(*flags))


def _untouched(plan: Plan) -> Trace:
    return keeper(plan, load_keeper(plan.scene)).untouched(plan.start)


def limits_struck(exit_code: int | None, output: str, excess: Message) -> tuple[Message, ...]:
    """Return remarks on the limits that a submission has hit.

    What the grader has measured itself (`excess`), or the kernel shows by its signal, is a fact.
    What a limit has refused only the process knows: its last lines are believed, since they excuse
    nothing.

    Args:
        exit_code: of the submission's process; None if it still ran.
        output: what it has printed.
        excess: what it used too much of, as measured from outside; NOTHING for none.
    """
    if excess:
        return (excess,)
    if exit_code is None or exit_code == 0:
        return ()
    if exit_code in SIGNALS:
        return (SIGNALS[exit_code],)
    last = output[-LAST_WORDS:].splitlines()[-MOST_LAST_LINES:]
    for error, remark in LAST_LINES.items():
        if any(line.strip().startswith(error) for line in last):
            return (msg("the node ended with {said}: {limit}", said=error, limit=remark),)
    return ()


def record(
    plan: Plan,
    trace: Trace,
    topics: tuple[PublishedTopic, ...],
    ending: Ending,
    observations: Observations = NO_OBSERVATIONS,
) -> Recording:
    """Put together the recording of a run that is over."""
    own, cast = split(trace)
    with scene_at_work(plan.scene):
        run = replace(
            ending.run,
            ticks=trace.ticks,
            simulated_s=trace.duration_ns / 1e9,
            wall_s=round(ending.run.wall_s, 3),
            trace_sha256=trace.sha256(),
            flags=(*ending.run.flags, *plan.flags),
            seed=plan.seed,
            interfaces=plan.interfaces,
            case=plan.case,
            drawn=plan.drawn,
        )
    kept = (own, run, topics, ending.output, plan.start, plan.scene, observations)
    return Recording(*kept, cast=cast)
