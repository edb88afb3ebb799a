"""What was handed in — a file, a folder, a package, a zip — and what of it to start.

Nothing of it is read in this process: a file can be made so that its parser takes all memory, or
falls over. `finding.py` has the rules, and goes by them in a process with limits, `reader.py`. A
package is inspected besides, in a process of the submission's: that evaluates its set-up and launch
files.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple, Protocol

from grader.scratch import make_folder
from grader.submission import reader
from grader.submission.folder import USUAL_NAME
from grader.submission.private_copy import PrivateCopy, copy_privately
from grader.submission.set_ups import NotInspected
from grader.submission.start import EntryPoint, Imports, Launch, Script, Submission, Whole

__all__ = [
    "EntryPoint",
    "Imports",
    "Launch",
    "Script",
    "Submission",
    "Whole",
]


class Inspect(Protocol):
    """What inspects a package, in a process of the submission's."""

    def __call__(self, submission: Submission, folders: Sequence[str], program: str) -> Seen:
        """What is said of the set-up files in some folders.

        Args:
            submission: all of what was handed in, in its copy.
            folders: below its root.
            program: the console script that is asked for, or the usual one.
        """


class Seen(NamedTuple):
    """What an inspection has said, and remarks on what kept it from saying more.

    Attributes:
        answer: a `grader.scenes.package.inspection.Inspection` as JSON.
        cpu_s: the processor time that it took [s].
        package: the folder of the package that `whole` is of.
        whole: a trace of the scene package; None where no more was looked at than needed.
    """

    answer: bytes
    remarks: tuple[str, ...] = ()
    cpu_s: float = 0.0
    package: str = ""
    whole: object = None


@contextmanager
def opened(
    path: Path,
    executable: str | None,
    inspect: Inspect,
    *,
    is_started: bool = True,
    usual: str = USUAL_NAME,
) -> Iterator[Submission]:
    """Find what to start, in a copy that is there until the context ends.

    See `grader.run.opening.open_submission`.
    """
    with make_folder() as folder:
        scratch = folder.resolve() / "submission"
        scratch.mkdir()
        try:
            found = reader.read(path, executable, scratch, is_started=is_started, usual=usual)
        except NotInspected as asked:
            yield _inspected(path, executable, scratch, usual, asked, inspect)
        else:
            yield _in_private(found, copy_privately(path, found.root, scratch))


def _inspected(
    path: Path,
    executable: str | None,
    scratch: Path,
    usual: str,
    asked: NotInspected,
    inspect: Inspect,
) -> Submission:
    """A package as it is started by what an inspection says."""
    copy = copy_privately(path, asked.base, scratch)
    whole = Submission(path.name, copy.of(asked.base), Whole(), "", copy=copy)
    seen = inspect(whole, asked.folders, executable or usual)
    found = reader.read(path, executable, scratch, usual=usual, again=(asked, seen.answer))
    if found.package == asked.base / seen.package and not found.added:
        found = replace(found, seen=seen.whole)
    found = replace(found, notes=(*seen.remarks, *found.notes), spent_s=seen.cpu_s)
    if found.added:  # it was mended in a copy of its own
        copy = copy_privately(path, found.root, scratch)
    return _in_private(found, copy)


def _in_private(submission: Submission, copy: PrivateCopy) -> Submission:
    """The same in a copy of its own."""
    start = submission.start
    if isinstance(start, Script):
        start = replace(start, path=copy.of(start.path))
    root, package = copy.of(submission.root), submission.package and copy.of(submission.package)
    return replace(submission, root=root, start=start, package=package, copy=copy)
