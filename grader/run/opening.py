"""`open_submission`: find what to start in a file, a folder, a package or an archive.

Nothing of it is parsed in this process: a file can be made so that its parser takes all memory, or
crashes. `grader.submission.program_choice` has the rules, and applies them in a process with
limits. A single file is found without running anything. What a package has to start stands in its
set-up and launch files, so an inspection evaluates them first, in a process confined like the
submission's.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from grader.run.limits import CpuBudget
from grader.submission import reader
from grader.submission.private_copy import PrivateCopy, copy_privately, install
from grader.submission.reader import Marks
from grader.submission.request import LaunchAsked, Request
from grader.submission.set_ups import Unevaluated
from grader.submission.start import Submission
from grader.system.scratch import make_folder
from grader.text.message import NOTHING, Message

if TYPE_CHECKING:
    from grader.submission.package_trace import PackageTrace


@contextmanager
def open_submission(
    path: Path,
    executable: str | None = None,
    launch: LaunchAsked | None = None,
    *,
    cpu_s: float = math.inf,
    **of_exercise: Any,
) -> Iterator[Submission]:
    """Find what to start, in a copy that is removed when the context ends.

    Where nothing is started, the submission is all of it, a folder or an archive with a package.

    Args:
        executable: chooses among console scripts or Python files; a single .py file leaves no
            choice. Where nothing is started, among packages.
        launch: the launch file that is asked for.
        cpu_s: the processor time that it may use [s].
        of_exercise: the other attributes of a `Request`, as `Exercise.opening` has them.

    Raises:
        SubmissionError: there is nothing to start, no way to tell what, or too much to be read.
        UsageError: there is no such path; or a choice is asked for where there is none.
        OSError: something is wrong with the machine.
        GraderFailure: it could not be read or inspected, for a reason of ours.
    """
    request = Request(executable, launch, **of_exercise)
    with make_folder() as folder:
        scratch = folder.resolve() / "submission"
        scratch.mkdir()
        found = reader.read(path, request, scratch)
        if isinstance(found, Unevaluated):
            found, copy = _evaluated(path, scratch, found, request, CpuBudget(cpu_s))
        else:
            copy = copy_privately(path, found.root, scratch)
        yield replace(found.with_paths(copy.of), copy=copy)


def marks_of(path: Path) -> Marks:
    """Return what a submission shows of its exercise, before it is opened for one."""
    with make_folder() as scratch:
        return reader.read_marks(path, scratch.resolve())


def _evaluated(
    path: Path, scratch: Path, package: Unevaluated, request: Request, budget: CpuBudget
) -> tuple[Submission, PrivateCopy]:
    """Return a package as it is started according to an inspection, and its copy."""
    from grader.run import inspecting  # here: most submissions are a file

    copy = copy_privately(path, package.base, scratch)
    everything = Submission(path.name, copy.of(package.base), (), NOTHING, copy=copy)
    inspection, remarks = inspecting.inspect(everything, package.folders, request, budget)
    name = path.name or path.resolve().name
    found = reader.read_evaluated(package, inspection, name, request, scratch)
    notes = (*remarks, *found.notes)
    if request.inspections is None:  # else that is reported with the run
        notes = (*notes, *_by_itself(found, inspection.trace))
    elif (
        inspection.trace.setup
        and found.package == package.base / inspection.package
        and not found.added
    ):
        found = replace(found, seen=inspection.trace)
    if found.added:  # it was repaired in a copy of its own
        copy = copy_privately(path, found.root, scratch)
    copy = install(copy, inspection.set_ups)
    return replace(found, notes=notes, spent_s=budget.spent_s), copy


def _by_itself(submission: Submission, trace: PackageTrace) -> list[Message]:
    """Return notes on how a program started by itself differs from its start by launch files."""
    from grader.submission.launched import not_installed, not_read, unlike_launched

    if not submission.is_by_itself:
        return not_installed(trace)
    entry = submission.entry
    return [*not_installed(trace), *not_read(trace, entry), *unlike_launched(trace, entry)]
