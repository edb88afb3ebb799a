"""What is made of all entries of a class together, at the end of each call.

Nothing of it tells when or how fast anything was graded: the same entries give the same bytes.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from grader.batch.entry import Entry
from grader.exercise.loading import Exercise


def write(out: Path, entries: Sequence[Entry], exercise: Exercise) -> None:
    """Write gradebook and pages.

    Raises:
        UsageError: one of them cannot be written.
    """
