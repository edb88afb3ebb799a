"""`open_submission`: what was handed in, and what of it to start.

A single file is found without running anything. What a package has to start, its set-up and launch
files say, so they are evaluated first, by one look in a process of the submission's
(`static.inspect`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from grader.language.phrase import say
from grader.run.budget import Budget
from grader.submission import opening
from grader.submission.folder import USUAL_NAME
from grader.submission.opening import EntryPoint, Seen, Submission

if TYPE_CHECKING:
    from grader.scenes.package.inspection import Inspection


@contextmanager
def open_submission(
    path: Path,
    executable: str | None = None,
    *,
    is_started: bool = True,
    usual: str = USUAL_NAME,
    is_whole: bool = False,
    cpu_s: float = math.inf,
) -> Iterator[Submission]:
    """Find what to start, in a copy that is there until the context ends.

    `executable` chooses among the console scripts or Python files of a folder or zip; a single
    .py file leaves no choice. Without it, `usual` is taken where there are several. Where nothing
    is started (`is_started`), all of it is taken, which must be a folder or an archive with a
    package; `executable` then chooses among packages.

    Args:
        is_whole: whether the package around what is started is looked at as well, which is done
            by the same look.
        cpu_s: the processor time that it may take [s].

    Raises:
        SubmissionError: there is nothing to start, no way to tell what, or too much to be read.
        UsageError: there is no such path; or a choice is asked for where there is none.
        OSError: something is wrong with the machine.
        GraderFailure: it could not be read or inspected, for a reason of ours.
    """
    inspected: list[Inspection] = []

    def inspect(submission: Submission, folders: Sequence[str], program: str) -> Seen:
        from grader.run import static  # here: most submissions are a file
        from grader.scenes.package.inspection import encode

        budget = Budget(cpu_s)
        said, remarks = static.inspect(submission, folders, program, budget, is_whole=is_whole)
        inspected.append(said)
        whole = said.trace if is_whole and said.trace.setup is not None else None
        return Seen(encode(said), remarks, budget.spent_s, said.package, whole)

    with opening.opened(
        path, executable, inspect, is_started=is_started, usual=usual
    ) as submission:
        if inspected and not is_whole:  # a whole look is told of with the run
            submission = replace(
                submission, notes=(*submission.notes, *_unlike(submission, inspected[0]))
            )
        yield submission


def _unlike(submission: Submission, said: Inspection) -> Iterator[str]:
    """In what the start of a program by itself differs from what launch files make of it."""
    from grader.scenes.package.by_itself import unlike_launched
    from grader.scenes.package.said import said as told

    start, setup = submission.start, said.trace.setup
    if not isinstance(start, EntryPoint) or setup is None:
        return
    target = (start.module, start.function)
    name = next((s.name for s in setup.scripts if (s.module, s.function) == target), "")
    for launch in said.trace.launches:
        if name and launch.problem is not None:
            yield say(
                "{file} was not run, and what it starts cannot be read ({unread}): "
                "judged is {program} alone",
                file=launch.file,
                unread=told(launch.problem),
                program=name,
            )
    yield from unlike_launched(said.trace, *target)
