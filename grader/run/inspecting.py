"""Inspects packages in one confined process, without a clock.

It starts nothing of the submission, but evaluates a stranger's set-up and launch files. So it is
confined as a submission's process is, and its findings are decoded as strictly as anything that a
submission sends. It has three uses:

- `run`: the only run where a scene has no nodes.
- `inspect`: finds what a package has to start.
- `inspect_beside`: beside the nominal run, where an exercise has the package around the program
  inspected, unless `inspect` has done so.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Final

from grader.errors import GraderFailure
from grader.recording.recording import Outcome, Recording
from grader.recording.subject import Trace, load_keeper
from grader.run import handover, run_context
from grader.run.environment import virtual_environment
from grader.run.finish import Ending, ended, record
from grader.run.handover import Plan
from grader.run.limits import INSPECTION_BYTES, INSPECTION_S, CpuBudget
from grader.run.processes.started_process import SubmissionProcess
from grader.submission import answer, inspector
from grader.submission.answer import Inspection, SetUp
from grader.submission.launched import unlike_launched
from grader.submission.package_trace import FAILED, PackageTrace
from grader.submission.request import Request
from grader.submission.start import Submission
from grader.system import linux
from grader.text.message import Message, msg

#: The program that examines a package, from `ROOT` on.
EXAMINER: Final = "grader/submission/examining/main.py"
#: How often the process is checked for being stopped [s], and how many checks together decide.
EVERY_S, STOPPED_CHECKS = 0.5, 4
ROOT: Final = Path(__file__).resolve().parents[2]
STOPPED: Final = msg("the package's own code has stopped (SIGSTOP) the process that looks at it")
_LOST: Final = msg(
    "the process that looked at the package left nothing that can be read: {why_not}"
)


def run(submission: Submission, plan: Plan, progress: object = None) -> Recording:
    """Inspect a submission once, as its only run, in which no time passes."""
    order = {"package": submission.asked, "inspectors": inspector.places(plan.inspections)}
    found, ending = _inspected(submission, order, plan.budget)
    trace = load_keeper(plan.scene).untouched(None) if found is None else found.trace
    return record(plan, trace, (), ending)


def inspect(
    submission: Submission,
    folders: Sequence[str],
    request: Request,
    budget: CpuBudget,
) -> tuple[Inspection, tuple[Message, ...]]:
    """Find what packages have to start; return it with remarks on what could not be found.

    Args:
        submission: all of it.
        folders: those with set-up files, below its root.
    """
    found, ending = _inspected(submission, order_of(folders, request), budget)
    if found is None or [each.folder for each in found.set_ups] != list(folders):
        found = Inspection(tuple(map(SetUp, folders)))
    return found, ending.run.flags


def order_of(folders: Sequence[str], request: Request) -> dict[str, object]:
    """Return what `grader.submission.examining.main.inspect` is asked; see `inspect`."""
    by = request.inspections
    return {
        "set_ups": list(folders),
        "program": (request.executable or request.usual).rpartition("/")[2],
        "inspectors": None if by is None else inspector.places(by),
        "launch": asdict(request.launch) if request.launch else {"file": ""},
    }


def inspect_beside(submission: Submission, plan: Plan) -> tuple[Trace, tuple[Message, ...]]:
    """Inspect the package in which a submission's program is, and those beside it.

    Returns:
        What was found, and remarks for the result: what could not be found, and what launch files
        would have started otherwise.
    """
    found = submission.seen
    flags: tuple[Message, ...] = ()
    if not isinstance(found, PackageTrace):
        whole = replace(submission, root=submission.folder, programs=())
        added = [str((submission.root / each).relative_to(whole.root)) for each in submission.added]
        order = {"added": added, "inspectors": inspector.places(plan.inspections)}
        inspected, ending = _inspected(whole, order, plan.budget)
        found, flags = (inspected or Inspection()).trace, ending.run.flags
    unlike = unlike_launched(found, submission.entry) if submission.is_by_itself else []
    return found, (*flags, *unlike)


def _inspected(
    submission: Submission,
    asked: Mapping[str, object],
    budget: CpuBudget,
) -> tuple[Inspection | None, Ending]:
    """Inspect in a process; return its findings, None where they cannot be read, and its ending."""
    started = time.monotonic()
    with run_context.open_context(budget) as context:
        submission, process = context.start(
            submission,
            lambda private: command(private, asked, context.recording),
            (context.recording,),
            virtual_environment({}),
        )
        with process.ended_at_exit(gently=False):
            exit_code = _wait(process)
        found, lost = _fetch(context.recording)
    how: Outcome = "finished"
    if exit_code is None:
        how = "time_limit"
    elif lost:
        how = "killed" if exit_code < 0 else "crashed"
    ending = ended("virtual", submission, process, context.isolation, started, how, exit_code)
    if exit_code == FAILED:
        raise GraderFailure(_failure(ending.output))
    if exit_code is None:
        return found, ending.with_flags(STOPPED)
    remarks = (_LOST.given(why_not=lost),) if lost else ()
    return found, ending.with_flags(*ending.run.flags, *remarks)


def command(submission: Submission, asked: Mapping[str, object], leaves: int) -> list[str]:
    """Return the command of the process; `leaves`: the descriptor of the file for its findings."""
    order = {"root": str(submission.root), **asked, "leaves": leaves}
    if submission.package:
        order["folder"] = str(submission.package)
    return [sys.executable, str(ROOT / EXAMINER), json.dumps(order)]


def _wait(process: SubmissionProcess) -> int | None:
    """Wait for the process; return its exit code, None where its own code has stopped it."""
    end = time.monotonic() + INSPECTION_S
    stopped = 0
    while (left_s := end - time.monotonic()) > 0:
        exit_code = process.wait(min(EVERY_S, left_s))
        if exit_code is not None:
            return exit_code
        stopped = stopped + 1 if linux.process_stat(process.pid).is_stopped else 0
        if stopped >= STOPPED_CHECKS:
            return None
    seconds = f"{INSPECTION_S:.0f}"
    raise GraderFailure("looking at the package took more than {seconds} s", seconds=seconds)


def _failure(output: str) -> Message:
    """Return the message for a failed process, which no package should be able to cause."""
    last = next((line.strip() for line in reversed(output.splitlines()) if line.strip()), "")
    return msg(
        "the program that looks at packages failed: {last}. That is no "
        "fault of the package; please report it, with the package",
        last=last[:300],
    )


def _fetch(file: int) -> tuple[Inspection | None, str]:
    """Decode the findings of the process; return None, and why, where that is impossible."""
    try:
        return answer.decode(handover.read_bounded(file, INSPECTION_BYTES)), ""
    except (OSError, ValueError, RecursionError) as error:
        return None, f"{error!s:.200}"
