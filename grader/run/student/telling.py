"""What a submission's process tells of itself, by the lines of the submission's own files.

Nothing here waits, raises, or takes time of the run. It goes into the process's `account`; where
its threads are, Python's faulthandler writes there, at a signal or where the process dies by a
mistake in C.
"""

from __future__ import annotations

import faulthandler
import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from types import CodeType, FrameType, TracebackType
from typing import Any

from grader.run.student.account import Account

LONGEST = 300
#: A larger file is no source that somebody reads [bytes].
MOST_SOURCE_BYTES = 1_000_000
#: What is installed into a submission's own folder is not the student's; nor what lies beside it.
FOREIGN = ("/site-packages/", "/dist-packages/", "/../")
#: A frame and its line.
Line = tuple[FrameType, int]


class Teller:
    """What is the submission's own, and the account that tells of it.

    Attributes:
        root: the folder of the submission.
        account: what is told.
        now_s: tells the time [s since the start of this process] on the clock of the run.
    """

    def __init__(self, page: int, root: str, now_s: Callable[[], float]) -> None:
        """`page`: of the account; -1: nobody reads it."""
        self.root = root.rstrip("/") + "/"
        self.now_s = now_s
        self.account = Account(page)
        self._sources: dict[str, list[str]] = {}
        if page >= 0:
            os.set_inheritable(page, False)
            _dump_when_asked(page)

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


def asking_signal() -> int:
    """What the grader sends to hear where this process is; 0 where there is no such signal.

    None that a program has a use for, and none that Python's own handlers have to be run for: it is
    answered also where a program computes without end, or waits in C.
    """
    if sys.platform == "linux":
        return signal.SIGRTMIN + 9
    return 0


def _dump_when_asked(descriptor: int) -> None:
    """Write where all threads are, at the signal and where the process dies by a mistake in C."""
    if number := asking_signal():
        with suppress(OSError, RuntimeError, ValueError):
            faulthandler.register(number, descriptor, all_threads=True)
    with suppress(OSError, RuntimeError, ValueError):
        faulthandler.enable(descriptor)
