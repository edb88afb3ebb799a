"""The submission's files, and their lines in a stack or a traceback.

Lines are rows of JSON, see `grader.recording.observations.SourceLine`. Used on both sides; in the
submission's process nothing here waits, raises, or costs virtual time.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from traceback import walk_stack, walk_tb
from types import CodeType, FrameType
from typing import Any

#: So much of a name, a line or a text is kept [characters].
LONGEST = 300
#: A larger file is not read as source [bytes].
MOST_SOURCE_BYTES = 1_000_000
#: What is installed into a submission's folder is not the student's; nor what lies beside it.
NOT_STUDENTS = ("/site-packages/", "/dist-packages/", "/../")

Row = dict[str, Any]


@dataclass(frozen=True)
class Frame:
    """A frame of a thread.

    Attributes:
        function: with its class where that is known, 'Client.call'; '' for none.
        lines: those of its file where that is the submission's; None for others.
    """

    file: str
    line: int
    function: str
    lines: Sequence[str] | None = None

    @property
    def name(self) -> str:
        return self.function.rpartition(".")[2]

    @property
    def library(self) -> str:
        """The file with its folder, which tells files of one name in a library apart."""
        return "/".join(self.file.rsplit("/", 2)[-2:])


class SubmissionFiles:
    """The files of a submission below its root."""

    def __init__(self, root: str) -> None:
        self._root = root.rstrip("/") + "/"
        self._lines: dict[str, list[str]] = {}

    def name(self, file: str) -> str:
        """Return a file's path below the root; '' for a file that is not the submission's."""
        name = file.removeprefix(self._root)
        is_students = name != file and not any(each in f"/{name}" for each in NOT_STUDENTS)
        return name if is_students else ""

    def has(self, file: str) -> bool:
        """Whether a file is one of the submission's."""
        return bool(self.name(file))

    def lines(self, file: str) -> list[str]:
        """Return the lines of one of the submission's files; none of any other."""
        if not self.has(file):
            return []
        if file not in self._lines:
            # a link may lead anywhere, also to itself; and a file has any number of names
            path = os.path.realpath(file)
            if path not in self._lines:
                is_inside = path.startswith(os.path.realpath(self._root) + "/")
                self._lines[path] = _read(Path(path)) if is_inside else []
            self._lines[file] = self._lines[path]
        return self._lines[file]

    # Lines ------------------------------------------------------------------------------------

    def row(self, file: str, line: int, function: str = "") -> Row:
        """Return a line of one of the submission's files, by its number."""
        lines = self.lines(file)
        return {
            "file": self.name(file)[:LONGEST],
            "line": line,
            "function": function[:LONGEST],
            "text": lines[line - 1].strip()[:LONGEST] if 0 < line <= len(lines) else "",
        }

    def row_of_frame(self, frame: Frame) -> Row:
        """Return the line of a frame of the submission's."""
        return self.row(frame.file, frame.line, frame.function)

    def row_of(self, code: CodeType, line: int) -> Row:
        """Return a line of some code of the submission's."""
        return self.row(code.co_filename, line, _function(code))

    def innermost(self, frame: FrameType | None) -> FrameType | None:
        """Return the innermost frame of the submission's, from this one outwards."""
        while frame is not None and not self.has(frame.f_code.co_filename):
            frame = frame.f_back
        return frame

    def place(self, frame: FrameType | None) -> Row | None:
        """Return the line of the innermost frame of the submission's."""
        frame = self.innermost(frame)
        return None if frame is None else self.row_of(frame.f_code, frame.f_lineno)

    # Threads ----------------------------------------------------------------------------------

    def frame(self, file: str, line: int, function: str) -> Frame:
        """Return a frame, with the lines of its file."""
        return Frame(file, line, function, self.lines(file) if self.has(file) else None)

    def stack(self, frame: FrameType | None) -> list[Frame]:
        """Return the frames of a thread, innermost first."""
        return self._frames(walk_stack(frame)) if frame is not None else []

    def trace(self, error: BaseException) -> list[Frame]:
        """Return the frames of an exception's traceback, innermost first."""
        return self._frames(walk_tb(error.__traceback__))[::-1]

    def _frames(self, walked: Iterable[tuple[FrameType, int]]) -> list[Frame]:
        return [
            self.frame(frame.f_code.co_filename, line, _function(frame.f_code))
            for frame, line in walked
        ]


def _read(path: Path) -> list[str]:
    try:
        if path.is_file() and path.stat().st_size <= MOST_SOURCE_BYTES:
            return path.read_text(encoding="utf-8", errors="replace").splitlines()
    except (OSError, ValueError):
        pass
    return []


def text(error: BaseException) -> str:
    """Return the text of an exception, cut to what is kept."""
    try:
        return str(error)[:LONGEST]
    except Exception:
        return ""


def _function(code: CodeType) -> str:
    if code.co_name == "<module>":
        return ""
    return code.co_qualname.rpartition("<locals>.")[2]
