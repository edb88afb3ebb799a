"""Finds where a program is stuck: in a deadlock, a loop, an `__init__` that never ends.

Found from the frames of its threads alone, innermost first, which come from the process itself or
from a dump of Python's faulthandler. Nothing is parsed: a file can be made so that Python's parser
does not survive it.
"""

from __future__ import annotations

import re
import traceback
from collections.abc import Sequence
from dataclasses import dataclass, replace

from grader.run.lockstep import faults
from grader.run.observe.files import LONGEST, Frame, Row, SubmissionFiles

Thread = Sequence[Frame]
#: Functions of rclpy that wait for another thread to spin, and what a program calls them by.
WAITS = {
    ("rclpy/client.py", "call"): "Client.call",
    ("rclpy/timer.py", "sleep"): "Rate.sleep",
    ("action/client.py", "send_goal"): "ActionClient.send_goal",
    ("action/client.py", "_get_result"): "ActionClient.get_result",
    ("action/client.py", "_cancel_goal"): "ActionClient.cancel_goal",
}
#: Where spinning is done.
SPINS = ("rclpy/executors.py", "rclpy/__init__.py")
#: How a loop begins, one that has no condition, and a block that no loop round it is sought beyond.
LOOP = re.compile(r"\s*(?:async\s+)?(?:while|for)\b")
ENDLESS = re.compile(r"while\s*\(?(?:True|1)\)?\s*:.*")
BLOCK = re.compile(r"\s*(?:async\s+)?(?:def|class)\b")
MOST_INDENT = 10_000

MESSAGE = """
Your node is stuck here, at {time_s:.2f} s: it waits for something that can no longer happen.
{stack}{advice}
"""
IN_CALLBACK = """\
This is a callback. While it waits, the executor can hand out no other callback of the same group:
not the answer, message or timer that it waits for. Do not wait in a callback: use call_async() and
add_done_callback(), or an `async def` callback that awaits the future."""
OUTSIDE = """\
Nobody spins this node while this call waits, so no answer, message or timer can reach it. Spin in
another thread, or use rclpy.spin_until_future_complete()."""


@dataclass(frozen=True)
class Stuck:
    """Where a thread is stuck.

    Attributes:
        kind: as in `grader.recording.observations.Standstill`.
        frame: the submission's frame, which has the line.
        call: the function that is called there, as 'Client.call'; '' for none.
    """

    kind: str
    frame: Frame
    call: str = ""

    def row(self, files: SubmissionFiles, time_s: float) -> Row:
        """Return its row of an account, at a time on the clock of the run [s]."""
        place = files.row_of_frame(self.frame)
        return {"kind": self.kind, "time_s": time_s, "call": self.call, "place": place}


# Threads that wait ----------------------------------------------------------------------------


def deadlock(threads: Sequence[Thread]) -> tuple[str, Thread] | None:
    """Find the stuck thread among threads that all are blocked for good.

    Returns:
        'callback' or 'call', and the thread; None where they only wait, as after the work is done.
    """
    for thread in threads:
        if any(map(_runs_callback, thread)):
            return "callback", thread
        if any(map(_waits, thread)):
            return "call", thread
    return None


def is_spinning(thread: Thread) -> bool:
    return any(frame.name == "spin" and frame.library in SPINS for frame in thread)


def explain(kind: str, thread: Thread, time_s: float) -> str:
    """Return the message that is printed for the author of a submission with a stuck thread."""
    shown = [
        traceback.FrameSummary(frame.file, frame.line, frame.name or "<module>")
        for frame in reversed(thread)
        if not (faults.is_ours(frame.file) or faults.is_loader(frame.file))
    ]
    stack = "".join(traceback.StackSummary.from_list(shown).format())
    advice = IN_CALLBACK if kind == "callback" else OUTSIDE
    return MESSAGE.format(time_s=time_s, stack=stack, advice=advice)


def called(kind: str, thread: Thread) -> Stuck | None:
    """Return the submission's line in which a thread waits; None where there is none."""
    at = _students(thread)
    if at < 0:
        return None
    call = _called_by(thread[at - 1]) if at else ""
    return Stuck(kind, thread[at], call)


def waiting(threads: Sequence[Thread]) -> Stuck | None:
    """Return where a thread waits in a callback or a call, while no other spins."""
    spinning = [thread for thread in threads if any(map(in_spin, thread))]
    for thread in threads:
        at = _students(thread)
        if at <= 0:
            continue
        waits = any(map(_waits, thread[:at]))
        is_callback = any(map(_runs_callback, thread[at:]))
        if is_callback and [thread] == spinning and (waits or any(map(in_spin, thread[:at]))):
            return called("callback", thread)
        if waits and not spinning:
            return called("call", thread)
    return None


def at_end(thread: Thread) -> Stuck | None:
    """Return where a main thread was at the end of a run; None where it just spun."""
    found = waiting([thread])
    return found if found is not None and found.kind == "callback" else standing(thread)


# Threads that run -----------------------------------------------------------------------------


def computing(threads: Sequence[Thread]) -> Stuck | None:
    """Return the loop of the thread that computes: in the submission's code, or called last."""
    found = [(at, thread) for thread in threads if (at := _students(thread)) >= 0]
    if not found:
        return None
    _, thread = min(found, key=lambda each: each[0])
    loop = _head(thread[_students(thread) :])
    return Stuck("loop", loop) if loop else called("loop", thread)


def standing(thread: Thread) -> Stuck | None:
    """Return where a main thread was at the end of a run; None where it just spun."""
    at = _students(thread)
    if at < 0:
        return None
    inside = thread[:at]
    spins = is_spinning(inside)
    inits = (n for n, each in enumerate(thread) if each.lines is not None)
    init = max((n for n in inits if thread[n].name == "__init__"), default=-1)
    if init >= 0 and not any(map(_runs_callback, thread)):
        if spins:
            return Stuck("init", thread[at])  # no chance: there it stays
        return Stuck("init", _head(thread[at : init + 1]) or thread[init])
    if spins and loops_around(thread[at].lines or (), thread[at].line):
        return Stuck("spin", thread[at])
    if any(in_spin(frame) for frame in inside):
        return None
    loop = _head(thread[at:])
    return Stuck("going", loop) if loop else None


def _head(frames: Thread) -> Frame | None:
    """Return the first line of the loop in which a thread is; None for no loop.

    The line in the loop is chance, its beginning is not. Of several loops it is the innermost that
    has no condition, else the outermost.
    """
    heads: list[tuple[str, Frame]] = []
    for frame in frames:
        if frame.lines is None:
            break
        for number in loops_around(frame.lines, frame.line):
            text = frame.lines[number - 1].split("#")[0].strip()
            heads.append((text, replace(frame, line=number)))
    endless = [frame for text, frame in heads if ENDLESS.fullmatch(text)]
    whiles = [frame for text, frame in heads if text.startswith("while")]
    every = [frame for _, frame in heads]
    return next(iter(endless or whiles[::-1] or every[::-1]), None)


def loops_around(lines: Sequence[str], number: int) -> list[int]:
    """Return the first lines of the loops that a line is in, innermost first, by indentation."""
    found, indent = [], MOST_INDENT
    for at in range(min(number, len(lines)), 0, -1):
        text = lines[at - 1].expandtabs()
        blanks = len(text) - len(text.lstrip())
        if blanks == len(text) or blanks >= indent or text.lstrip().startswith("#"):
            continue
        indent = blanks
        if LOOP.match(text):
            found.append(at)
        elif BLOCK.match(text):
            break
    return found


# Frames ---------------------------------------------------------------------------------------


def _students(thread: Thread) -> int:
    """Return the index of the innermost frame of the submission's; -1: none."""
    return next((at for at, frame in enumerate(thread) if frame.lines is not None), -1)


def last_line(thread: Thread) -> Frame | None:
    """Return the innermost frame of the submission's."""
    at = _students(thread)
    return thread[at] if at >= 0 else None


def _runs_callback(frame: Frame) -> bool:
    return frame.library == "rclpy/task.py" and frame.name == "__call__"


def _waits(frame: Frame) -> bool:
    return (frame.library, frame.name) in WAITS


def in_spin(frame: Frame) -> bool:
    """Whether a frame is of a function that spins, for once or for ever."""
    return frame.library in SPINS and "spin" in frame.name


def _called_by(frame: Frame) -> str:
    """Return a function's name as the author has written it."""
    return WAITS.get((frame.library, frame.name), frame.function)[:LONGEST]
