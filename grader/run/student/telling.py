"""How a submission's process tells of itself while it lives: lines of JSON into a pipe.

What is told goes at once, so that a process that is killed has told what it knew. Nothing here
waits, raises, or takes time of the run: where the pipe is full or closed, nobody hears of it.
`grader.run.evidence` reads it, and says what a line may hold.
"""

from __future__ import annotations

import faulthandler
import json
import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from types import CodeType, FrameType, TracebackType
from typing import Any

#: So much is told of what goes on [bytes]; the rest of the pipe is for how it ends.
MOST_BYTES = 40_000
#: One line of it is never cut.
MOST_LINE_BYTES = 4000
LONGEST = 300
#: A larger file is no source that somebody reads [bytes].
MOST_SOURCE_BYTES = 1_000_000
#: What is installed into a submission's own folder is not the student's; nor what lies beside it.
FOREIGN = ("/site-packages/", "/dist-packages/", "/../")
#: A frame and its line.
Line = tuple[FrameType, int]


class Teller:
    """The pipe, and what is the submission's own.

    Attributes:
        root: the folder of the submission.
        now_s: tells the time [s since the start of this process] on the clock of the run.
    """

    def __init__(self, descriptor: int, root: str, now_s: Callable[[], float]) -> None:
        """`descriptor`: -1: nobody listens."""
        self.root = root.rstrip("/") + "/"
        self.now_s = now_s
        self._descriptor = descriptor
        self._process = os.getpid()
        self._told = 0
        self._sources: dict[str, list[str]] = {}
        self._identity = _identity(descriptor)
        if descriptor >= 0:
            os.set_inheritable(descriptor, False)
            os.set_blocking(descriptor, False)
            _tell_when_asked(descriptor)
            self.tell("begun", 0.0)

    def tell(self, what: str, value: object, *, is_last: bool = False) -> None:
        """Tell something.

        Args:
            is_last: it is how the program ends, for which there is always room.
        """
        line = json.dumps({what: value}).encode("ascii", "replace") + b"\n"
        too_much = len(line) > MOST_LINE_BYTES or self._told + len(line) > MOST_BYTES
        if self._descriptor < 0 or (too_much and not is_last) or self._is_another():
            return
        self._told += len(line)
        with suppress(OSError):
            os.write(self._descriptor, line)

    def _is_another(self) -> bool:
        """Whether this is a fork, or the program has closed the pipe and opened something else."""
        return os.getpid() != self._process or _identity(self._descriptor) != self._identity

    # Places -----------------------------------------------------------------------------------

    def is_own(self, file: str) -> bool:
        """Whether a file is one of the submission's own."""
        return file.startswith(self.root) and not any(each in file for each in FOREIGN)

    def own(self, lines: list[Line]) -> int:
        """Which of these, outermost first, is the last of the submission's own; -1: none."""
        for at in range(len(lines) - 1, -1, -1):
            if self.is_own(lines[at][0].f_code.co_filename):
                return at
        return -1

    def own_frame(self, frame: FrameType | None) -> FrameType | None:
        """The innermost frame of the submission's own that has led to this one."""
        while frame is not None and not self.is_own(frame.f_code.co_filename):
            frame = frame.f_back
        return frame

    def place(self, frame: FrameType | None) -> dict[str, Any] | None:
        """The line of the submission's own that has led to this frame."""
        frame = self.own_frame(frame)
        return None if frame is None else self.line(frame.f_code, frame.f_lineno)

    def line(self, code: CodeType, number: int) -> dict[str, Any]:
        """A line of the submission's own, as a `grader.recording.conduct.Place`."""
        return self.place_in(code.co_filename, number, _function(code))

    def place_in(self, file: str, number: int, function: str = "") -> dict[str, Any]:
        """A line of a file of the submission's own, by the number."""
        return {
            "file": file.removeprefix(self.root)[:LONGEST],
            "line": number,
            "function": function[:LONGEST],
            "text": self._text(file, number),
        }

    def source(self, file: str) -> list[str]:
        """The lines of a file of the submission's own."""
        if file not in self._sources:
            self._sources[file] = []
            with suppress(OSError):
                data = Path(file).read_bytes()[:MOST_SOURCE_BYTES]
                self._sources[file] = data.decode("utf-8", "replace").splitlines()
        return self._sources[file]

    def _text(self, file: str, number: int) -> str:
        lines = self.source(file)
        return lines[number - 1].strip()[:LONGEST] if 0 < number <= len(lines) else ""


def stack(frame: FrameType | None) -> list[Line]:
    """Where a thread is, outermost first."""
    return list(_outwards(frame))[::-1]


def text(error: BaseException) -> str:
    """What an exception says, as far as it is told."""
    try:
        return str(error)[:LONGEST]
    except Exception:
        return ""


def trace(traceback: TracebackType | None) -> list[Line]:
    """Where an exception has come from, outermost first."""
    found: list[Line] = []
    while traceback is not None:
        found.append((traceback.tb_frame, traceback.tb_lineno))
        traceback = traceback.tb_next
    return found


def called(lines: list[Line], at: int) -> str:
    """The function that one of these lines was in, as 'Client.call'; '' where it has called none.

    It is the first that is not the submission's own, which is what its author has written.
    """
    return _function(lines[at + 1][0].f_code)[:LONGEST] if at + 1 < len(lines) else ""


def _function(code: CodeType) -> str:
    if code.co_name == "<module>":
        return ""
    return code.co_qualname.rpartition("<locals>.")[2]


def _outwards(frame: FrameType | None) -> Iterator[Line]:
    while frame is not None:
        yield frame, frame.f_lineno
        frame = frame.f_back


def _identity(descriptor: int) -> tuple[int, int]:
    try:
        found = os.fstat(descriptor)
    except OSError:
        return 0, 0
    return found.st_dev, found.st_ino


def asking_signal() -> int:
    """What the grader sends to hear where this process is; 0 where there is no such signal.

    None that a program has a use for, and none that Python's own handlers have to be run for: it is
    answered also where a program computes without end, or waits in C.
    """
    if sys.platform == "linux":
        return signal.SIGRTMIN + 9
    return 0


def _tell_when_asked(descriptor: int) -> None:
    """Write where all threads are, at the signal and where the process dies by a mistake in C."""
    if number := asking_signal():
        with suppress(OSError, RuntimeError, ValueError):
            faulthandler.register(number, descriptor, all_threads=True)
    with suppress(OSError, RuntimeError, ValueError):
        faulthandler.enable(descriptor)
