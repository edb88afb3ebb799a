"""What was found, for tests: in a copy that goes, but told as it was handed in."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from grader.submission.start import Script, Submission


def in_place(submission: Submission) -> Submission:
    """The same with the paths that were handed in."""
    copy = submission.copy
    assert copy is not None

    def back(path: Path) -> Path:
        return copy.origin / path.relative_to(copy.folder)

    start = submission.start
    if isinstance(start, Script):
        start = replace(start, path=back(start.path))
    return replace(submission, root=back(submission.root), start=start)
