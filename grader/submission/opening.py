"""What was handed in — a file, a folder, a package, a zip — and what of it to start.

Nothing of it is run or imported to find out, and nothing of it is read in this process: a file can
be made so that its parser takes all memory, or falls over. `finding.py` has the rules, and goes by
them in a process with limits, `reader.py`.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from grader.scratch import make_folder
from grader.submission import reader
from grader.submission.folder import USUAL_NAME
from grader.submission.private_copy import copy_privately
from grader.submission.start import EntryPoint, Imports, Launch, Script, Submission, Whole

__all__ = [
    "EntryPoint",
    "Imports",
    "Launch",
    "Script",
    "Submission",
    "Whole",
    "open_submission",
]


@contextmanager
def open_submission(
    path: Path,
    executable: str | None = None,
    *,
    is_started: bool = True,
    usual: str = USUAL_NAME,
) -> Iterator[Submission]:
    """Find what to start, in a copy that is there until the context ends.

    `executable` chooses among the console scripts or Python files of a folder or zip; a single
    .py file leaves no choice. Without it, `usual` is taken where there are several. Where nothing
    is started (`is_started`), all of it is taken, which must be a folder or an archive with a
    package; `executable` then chooses among packages.

    Raises:
        SubmissionError: there is nothing to start, no way to tell what, or too much to be read.
        UsageError: there is no such path; or a choice is asked for where there is none.
        OSError: something is wrong with the machine.
        GraderFailure: it could not be read, for a reason of ours.
    """
    with make_folder() as folder:
        scratch = folder.resolve() / "submission"
        scratch.mkdir()
        found = reader.read(path, executable, scratch, is_started=is_started, usual=usual)
        yield _in_private(found, path, scratch)


def _in_private(submission: Submission, path: Path, scratch: Path) -> Submission:
    """The same in a copy of its own."""
    copy = copy_privately(path, submission.root, scratch)
    start = submission.start
    if isinstance(start, Script):
        start = replace(start, path=copy.of(start.path))
    root, package = copy.of(submission.root), submission.package and copy.of(submission.package)
    return replace(submission, root=root, start=start, package=package, copy=copy)
