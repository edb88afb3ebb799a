"""Where a process was that could not say so itself: what Python's faulthandler has written of it.

It is written in C, at a signal, also where a program computes without end or has just made a
mistake that the kernel ends it for. Like all evidence it is the submission's own, and read so.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from grader.run.student import loops
from grader.run.student.telling import FOREIGN
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
#: Functions of rclpy that wait for another thread to spin, and what they are called.
WAITS = {
    ("rclpy/client.py", "call"): "Client.call",
    ("rclpy/timer.py", "sleep"): "Rate.sleep",
    ("action/client.py", "send_goal"): "ActionClient.send_goal",
    ("action/client.py", "_get_result"): "ActionClient.get_result",
    ("action/client.py", "_cancel_goal"): "ActionClient.cancel_goal",
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
        is_own = name != frame.file and not any(each in f"/{name}" for each in FOREIGN)
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


Thread = list[Frame]


@dataclass(frozen=True)
class Dump:
    """What was written.

    Attributes:
        fatal: the mistake in C; '' for none.
        threads: each with its frames, the innermost first; first of all the one that wrote it.
    """

    fatal: str
    threads: list[Thread]


def read(lines: Sequence[str]) -> Dump:
    """The last dump in these lines."""
    fatal, threads = "", list[Thread]()
    for line in lines:
        if found := _FATAL.match(line):
            fatal, threads = found[1], []
        elif _THREAD.match(line):
            threads.append([])
        elif (found := _FRAME.fullmatch(line)) and threads:
            threads[-1].append(Frame(found[1], int(found[2]), found[3]))
    return Dump(fatal, threads)


def ending(dump: Dump, own: Own, ended_s: float, *, computes: bool) -> dict[str, Any]:
    """How a process has ended, or where it went no further; nothing where no dump tells."""
    if dump.fatal:
        frames = [frame for frame in dump.threads[0] if own.name(frame)] if dump.threads else []
        place = own.place(frames[0]) if frames else None
        kind = FATAL.get(dump.fatal, dump.fatal)
        return {"raised": {"type": kind, "text": "", "time_s": ended_s, "place": place}}
    found = _loop(dump.threads, own) if computes else _standstill(dump.threads, own)
    if found is None:
        return {} if computes else _standing(dump.threads, own, ended_s)
    kind, thread, at = found
    frame, call = thread[at], _call(thread[at - 1]) if at else ""
    if kind == "loop" and (head := loops.head([_seen(each, own) for each in thread[at:]])):
        frame, call = replace(thread[at + head[0]], line=head[1]), ""
    return {
        "stop": {"kind": kind, "time_s": ended_s, "call": call, "place": own.place(frame)},
    }


def _loop(threads: list[Thread], own: Own) -> tuple[str, Thread, int] | None:
    """The thread that computes is in the submission's own code, or was called from there last."""
    found = [("loop", thread, _own(thread, own)) for thread in threads]
    return min((each for each in found if each[2] >= 0), key=lambda each: each[2], default=None)


def _standstill(threads: list[Thread], own: Own) -> tuple[str, Thread, int] | None:
    """A thread that waits in a callback or a call, while no other spins."""
    spinning = [thread for thread in threads if any(map(_spins, thread))]
    for thread in threads:
        at = _own(thread, own)
        if at <= 0:
            continue
        waits = any((_library(frame.file), frame.function) in WAITS for frame in thread[:at])
        callback = any(_library(frame.file) == "rclpy/task.py" for frame in thread[at:])
        if callback and [thread] == spinning and (waits or any(map(_spins, thread[:at]))):
            return "callback", thread, at
        if waits and not spinning:
            return "call", thread, at
    return None


def _standing(threads: list[Thread], own: Own, ended_s: float) -> dict[str, Any]:
    """Where the main thread was, which is the last; nothing where it just spun."""
    thread = threads[-1] if threads else []
    found = loops.standing([_seen(frame, own) for frame in thread])
    if found is None:
        return {}
    place = own.place(replace(thread[found.at], line=found.line))
    return {"stop": {"kind": found.kind, "time_s": ended_s, "call": "", "place": place}}


def _seen(frame: Frame, own: Own) -> loops.Seen:
    name = own.name(frame)
    return loops.Seen(frame.file, frame.function, frame.line, own.text(name) if name else None)


def _own(thread: Thread, own: Own) -> int:
    """Which frame is the last of the submission's own; -1: none."""
    return next((at for at, frame in enumerate(thread) if own.name(frame)), -1)


def _spins(frame: Frame) -> bool:
    return _library(frame.file) == "rclpy/executors.py" and "spin" in frame.function


def _library(file: str) -> str:
    """A file with its folder: of two of the same name in one library these are the same."""
    return "/".join(file.split("/")[-2:])


def _call(frame: Frame) -> str:
    return WAITS.get((_library(frame.file), frame.function), frame.function)[:LONGEST]
