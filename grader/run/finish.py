"""How a run ended, and the recording that is made of it."""

from __future__ import annotations

import time
from dataclasses import dataclass

from grader.recording.conduct import Conduct
from grader.recording.recording import Clock, Outcome, PublishedTopic, Recording, Run
from grader.run.plan import Plan
from grader.run.processes.sandbox.limits import LIMITS, size
from grader.run.processes.watched import Watched
from grader.scenes import load_scene
from grader.scenes.scene import Reason, Trace
from grader.submission.start import Submission

NOTHING_TOLD = Conduct()
#: How a scene says that there is nothing more to come.
DONE: tuple[Reason, ...] = ("rest", "seen")
#: How much of a process's output is looked at for why it ended [characters], [lines].
LAST_WORDS, MOST_LAST_LINES = 8192, 20
#: Exit codes that only a limit gives, SIGXCPU and SIGXFSZ, and what happened.
SIGNALS = {
    -24: f"the node used more than {LIMITS.cpu_s} s of processor time",
    -25: f"the node wrote a file of more than {size(LIMITS.file_bytes)}: a run may not",
}
_MEMORY = f"one process may ask for {size(LIMITS.data_bytes)} of memory"
_TASKS = f"a run may have {LIMITS.tasks} processes and threads"
_READ_ONLY = "a run may write into its own folder, tempfile.gettempdir() and ~, and nowhere else"
#: How the line begins with which a program ends that was refused something -> what the limit is.
LAST_LINES = {
    "MemoryError": _MEMORY,
    "numpy._core._exceptions._ArrayMemoryError": _MEMORY,
    "numpy.core._exceptions._ArrayMemoryError": _MEMORY,
    "what():  std::bad_alloc": _MEMORY,
    "OSError: [Errno 12]": _MEMORY,
    "OSError: [Errno 24]": f"a process may have {LIMITS.open_files} open files",
    "OSError: [Errno 30]": _READ_ONLY,
    "PermissionError: [Errno 13]": _READ_ONLY,
    "sqlite3.OperationalError: unable to open database file": _READ_ONLY,
    "OSError: [Errno 27]": f"a file may have {size(LIMITS.file_bytes)}",
    "OSError: [Errno 28]": "the folder for temporary files is full: there is little room in it",
    "RuntimeError: can't start new thread": _TASKS,
    "BlockingIOError: [Errno 11]": f"{_TASKS}, if that was one more",
}


@dataclass(frozen=True)
class Ending:
    """What the grader knows of a run beside its trace; see `grader.recording.recording.Run`."""

    time: Clock
    outcome: Outcome
    exit_code: int | None
    wall_s: float
    isolation: str
    output: str
    flags: tuple[str, ...] = ()


def ended(
    clock: Clock,
    submission: Submission,
    process: Watched,
    isolation: str,
    since_s: float,
    how: Outcome,
    exit_code: int | None,
    flags: tuple[str, ...] = (),
) -> Ending:
    """How a run ended of which nothing is to come.

    Args:
        process: the submission's.
        since_s: when it began, on the machine's monotonic clock [s].
    """
    output = submission.as_handed_in(process.output())
    struck = limits_struck(exit_code, output, process.excess)
    flags = (*map(submission.as_handed_in, flags), *struck)
    return Ending(clock, how, exit_code, time.monotonic() - since_s, isolation, output, flags)


def outcome(reason: Reason, exit_code: int | None) -> Outcome:
    """How a run ended: what the simulator saw, and how the submission's process ended."""
    if exit_code is None:
        return "finished" if reason in DONE else "time_limit"
    if exit_code < 0:
        return "killed"
    if exit_code > 0:
        return "crashed"
    return "finished" if reason in DONE else "exited"


def not_run(plan: Plan) -> Recording:
    """What is left of a run that was not begun: the grading had used up its budget."""
    ending = Ending(
        time="virtual",
        outcome="not_run",
        exit_code=None,
        wall_s=0.0,
        isolation="",
        output="",
        flags=(plan.budget.remark,),
    )
    return record(plan, load_scene(plan.scene).untouched(plan.start), (), ending)


def limits_struck(exit_code: int | None, output: str, excess: str) -> tuple[str, ...]:
    """Remarks on what a submission was refused, or ended for, because a run may use no more.

    What the grader has seen itself (`excess`) or the kernel tells by its signal is so. What a limit
    has refused only the process knows: its last words are believed, since they excuse nothing.

    Args:
        exit_code: of the submission's process; None if it still ran.
        output: what it has printed.
        excess: of what it took too much, as seen from outside; '' if of nothing.
    """
    if excess:
        return (excess,)
    if exit_code is None or exit_code == 0:
        return ()
    if exit_code in SIGNALS:
        return (SIGNALS[exit_code],)
    last = output[-LAST_WORDS:].splitlines()[-MOST_LAST_LINES:]
    for said, remark in LAST_LINES.items():
        if any(line.strip().startswith(said) for line in last):
            return (f"the node ended with {said}: {remark}",)
    return ()


def record(
    plan: Plan,
    trace: Trace,
    topics: tuple[PublishedTopic, ...],
    ending: Ending,
    conduct: Conduct = NOTHING_TOLD,
) -> Recording:
    """Everything about a run that is over."""
    return Recording(
        trace=trace,
        run=Run(
            time=ending.time,
            outcome=ending.outcome,
            exit_code=ending.exit_code,
            ticks=trace.ticks,
            simulated_s=trace.simulated_s,
            wall_s=round(ending.wall_s, 3),
            trace_sha256=trace.sha256(),
            isolation=ending.isolation,
            flags=(*ending.flags, *plan.flags),
            seed=plan.seed,
            interfaces=plan.interfaces,
        ),
        topics=topics,
        output=ending.output,
        start=plan.start,
        scene=plan.scene,
        conduct=conduct,
    )
