"""Find the recording that a path means, and the result beside it."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from grader.errors import UsageError
from grader.result.result import ARTIFACTS, RESULT, Result


@dataclass(frozen=True)
class RecordingPlace:
    """The place of a recording.

    Attributes:
        recording: its folder.
        older: the result beside it; None where there is none.
    """

    recording: Path
    older: Result | None

    @property
    def folder(self) -> Path:
        """The folder of the older result."""
        return self.recording.parent

    @property
    def name(self) -> str:
        """The name of the folder that contains the result, or else the recording."""
        at = Path(os.path.abspath(self.recording))  # noqa: PTH100  a link keeps its own name
        return at.parent.name if at.name == ARTIFACTS["recording"] else at.name


def find(given: Path) -> RecordingPlace:
    """Find a recording by its folder, that of its result, or a file in one of them."""
    folder = given if given.is_dir() else given.parent
    if (folder / ARTIFACTS["recording"]).is_dir():
        folder /= ARTIFACTS["recording"]
    elif not given.exists():
        return RecordingPlace(given, None)
    beside = folder.parent / RESULT
    try:
        older = Result.read(beside) if beside.is_file() else None
    except UsageError:  # another program's, or damaged
        older = None
    if older is not None and older.artifacts.get("recording") != folder.name:
        older = None
    return RecordingPlace(folder, older)
