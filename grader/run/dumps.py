"""Where a process was that could not say so itself: what Python's faulthandler has written of it.

It is written in C, at a signal, also where a program computes without end or has just made a
mistake that the kernel ends it for. Like all evidence it is the submission's own, and read so.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from grader.submission.opening import Submission

#: How a dump begins for a mistake in C, and which signal ended the process then.
FATAL = {
    "Aborted": "SIGABRT",
    "Segmentation fault": "SIGSEGV",
    "Bus error": "SIGBUS",
    "Floating-point exception": "SIGFPE",
    "Floating point exception": "SIGFPE",
    "Illegal instruction": "SIGILL",
}
LONGEST = 300
MOST_SOURCE_BYTES = 1_000_000
_FATAL = re.compile(r"Fatal Python error: ([\w\- ]{1,40})")
_THREAD = re.compile(
    r"(?:Current thread|Thread) 0x[0-9a-f]{1,16}.{0,40}\(most recent call first\):"
)
_FRAME = re.compile(r'  File "([^"]{1,500})", line (\d{1,9}) in (.{1,500})')


@dataclass(frozen=True)
class Frame:
    """A line of a dump."""

    file: str
    line: int
    function: str


class Own:
    """Which files are a submission's own, and what they are called to people."""

    def __init__(self, submission: Submission) -> None:
        self._root = submission.root
        top = submission.copy.folder if submission.copy else submission.root
        inside = self._root.relative_to(top).as_posix()
        self._before = "" if inside == "." else f"{inside}/"

    def as_handed_in(self, file: str) -> str:
        """The name of a file that the process knows by the submission's root."""
        return f"{self._before}{file}"

    def name(self, frame: Frame) -> str:
        """A frame's file below the submission's root; '' for others."""
        name = frame.file.removeprefix(f"{self._root}/")
        is_own = name != frame.file and "/site-packages/" not in name
        return name if is_own else ""

    def text(self, name: str) -> list[str]:
        """The lines of one of its files, as it was handed in; none of any other."""
        try:
            path = (self._root / name).resolve()
            if not path.is_relative_to(self._root.resolve()) or not path.is_file():
                return []
            if path.stat().st_size > MOST_SOURCE_BYTES:
                return []
            return path.read_text(encoding="utf-8", errors="replace").splitlines()
        except (OSError, ValueError):
            return []

    def place(self, frame: Frame) -> dict[str, Any]:
        """As a `grader.recording.conduct.Place`."""
        name = self.name(frame)
        lines = self.text(name)
        text = lines[frame.line - 1].strip() if 0 < frame.line <= len(lines) else ""
        function = "" if frame.function == "<module>" else frame.function
        return {
            "file": name[:LONGEST],
            "line": frame.line,
            "function": function[:LONGEST],
            "text": text[:LONGEST],
        }


def ending(lines: Sequence[str], own: Own, ended_s: float) -> dict[str, Any]:
    """How a process has ended, or where it went no further; nothing where no dump tells."""
    fatal, threads = "", list[list[Frame]]()
    for line in lines:
        if found := _FATAL.match(line):
            fatal, threads = found[1], []
        elif _THREAD.match(line):
            threads.append([])
        elif (found := _FRAME.fullmatch(line)) and threads:
            threads[-1].append(Frame(found[1], int(found[2]), found[3]))
    if fatal:
        # the first is that whose mistake it was
        frames = [frame for frame in (threads[0] if threads else []) if own.name(frame)]
        place = own.place(frames[0]) if frames else None
        told = {"type": FATAL.get(fatal, fatal), "text": "", "time_s": ended_s, "place": place}
        return {"raised": told}
    return _loop(threads, own, ended_s)


def _loop(threads: list[list[Frame]], own: Own, ended_s: float) -> dict[str, Any]:
    """The thread that computes is in the submission's own code, or was called from there last."""
    with_own = [frames for frames in threads if any(map(own.name, frames))]
    if not with_own:
        return {}
    depths = [next(n for n, f in enumerate(frames) if own.name(f)) for frames in with_own]
    frames, at = min(zip(with_own, depths, strict=True), key=lambda each: each[1])
    call = frames[at - 1].function[:LONGEST] if at else ""
    told = {"kind": "loop", "time_s": ended_s, "call": call, "place": own.place(frames[at])}
    return {"stop": told}
