"""Unpacks the archives of one submission, one inside another, up to MAX_LEVELS."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Final

from grader.errors import SubmissionError
from grader.text import shown

if TYPE_CHECKING:
    from grader.submission.safe_members import Budget

#: A zip of a course's server, in it the student's own, in that a zip once more by mistake.
MAX_LEVELS: Final = 3

_ENDINGS: Final = (".zip", ".tar", ".tar.gz", ".tgz")


def is_archive(path: Path) -> bool:
    """Whether a file can be unpacked, by its name."""
    return path.name.lower().endswith(_ENDINGS)


class Unpacking:
    """The archives of a submission, as they are unpacked; together they have one limit."""

    def __init__(self, scratch: Path) -> None:
        self.scratch = scratch
        self._places = [scratch / f"unpacked{level or ''}" for level in range(MAX_LEVELS)]
        self._budget: Budget | None = None

    def unpack(self, archive: Path) -> Path:
        """Unpack an archive; return the folder of its content."""
        from grader.submission.archive import unpack  # here: most submissions are none
        from grader.submission.safe_members import Budget

        if not self._places:
            raise SubmissionError(
                "{name} lies in an archive in an archive in an archive, which is too "
                "deep. Hand in the innermost.",
                name=shown(archive.name),
            )
        if not archive.is_file():
            raise SubmissionError("{name} is not an ordinary file.", name=shown(archive.name))
        self._budget = self._budget or Budget()
        place = self._places.pop(0)
        place.mkdir()
        unpack(archive, place, self._budget)
        return place
