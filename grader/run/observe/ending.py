"""Observes how a program has ended, or where it is stuck: in a deadlock, a loop, an `__init__`.

Where it is stuck is found from the frames of its threads alone, innermost first, which come from
the process itself or from a dump of Python's faulthandler. Nothing is parsed: a file can be made so
that Python's parser does not survive it.
"""

from __future__ import annotations

import re
import sys
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from types import CodeType
from typing import Any

from grader.run.lockstep import faults
from grader.run.observe.account import ProcessAccount, quietly
from grader.run.observe.files import LONGEST, Frame, Row, SubmissionFiles, text

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
    call = ""
    if at:  # as the author has written it
        frame = thread[at - 1]
        call = WAITS.get((frame.library, frame.name), frame.function)[:LONGEST]
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
    spins = any(each.name == "spin" and each.library in SPINS for each in inside)
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


# In the submission's process ------------------------------------------------------------------


class EndWitness:
    """The part of a summary about the end; of several ends the first counts.

    Attributes:
        row: its entries in the account; see `grader.recording.observations.Observations`.
    """

    def __init__(
        self, files: SubmissionFiles, account: ProcessAccount, now_s: Callable[[], float]
    ) -> None:
        """`now_s`: the time since the start of this process on the clock of the run [s]."""
        self._files, self._account, self._now_s = files, account, now_s
        self.row: Row = {"stop": None, "raised": None, "returned_s": None}
        self._has_ended = False
        #: where something that cannot be called was first given for a callback
        self._uncallable: Row | None = None

    # Stuck threads ----------------------------------------------------------------------------

    def deadlocked(self, threads: Sequence[int], main: int) -> bool:
        """Note that all threads are blocked for good; print a stuck one, return whether one is."""
        stacks = [self._stack(thread) for thread in threads]
        found = deadlock(stacks)
        if found is not None:
            print(explain(*found, self._now_s()), file=sys.stderr, flush=True)
        elif any(in_spin(frame) for stack in stacks for frame in stack):
            return False
        stop = called(*(found or ("call", self._stack(main))))
        if stop is not None:
            self._end("stop", stop.row(self._files, self._now_s()))
        return found is not None

    def over(self, main: int) -> None:
        """Note the end of the run; the program would have gone on. `main`: its main thread."""
        if not self._has_ended:
            found = quietly(lambda: at_end(self._stack(main)))
            if found is not None:
                self._note("stop", found.row(self._files, self._now_s()))
        self._account.write(is_last=True)

    def _stack(self, thread: int) -> list[Frame]:
        return self._files.stack(sys._current_frames().get(thread))

    # Exceptions -------------------------------------------------------------------------------

    def note_callback(self, callback: Any) -> None:
        """Note the callback of a timer or a future."""
        if self._uncallable is None and not callable(callback):
            self._uncallable = self._files.place(sys._getframe())

    def thread_raised(self, error: BaseException) -> None:
        """Note an exception that has ended a spinning thread; the program goes on without it."""
        if any(frame.library == "rclpy/executors.py" for frame in self._files.trace(error)):
            self._note("raised", error_row(error, self._place(error), self._now_s()))

    def raised(self, error: BaseException) -> None:
        """Note an exception that has ended the program, with our frames still in its traceback."""
        if isinstance(error.__cause__, StopIteration):  # it has left rclpy's coroutine
            error = error.__cause__
        if not isinstance(error, SystemExit) or error.code:
            self._end("raised", error_row(error, self._place(error), self._now_s()))

    def returned(self, code: int) -> None:
        """Note that the program has ended by itself."""
        if code == 0:
            self._end("returned_s", self._now_s())
        else:
            self._end("raised", error_row(SystemExit(code), None, self._now_s()))

    def _place(self, error: BaseException) -> Row | None:
        """Return the submission's line that an exception comes from."""
        last = last_line(self._files.trace(error))
        place = self._files.row_of_frame(last) if last else None
        if isinstance(error, SyntaxError):  # what imports the file is not wrong
            file, line = error.filename or "", (error.text or "").strip()[:LONGEST]
            if self._files.has(file):
                place = {**self._files.row(file, error.lineno or 0), "text": line}
        if isinstance(error, TypeError):
            place = self._callback(error) or place
        return place

    def _callback(self, error: TypeError) -> Row | None:
        """Return the callback that rclpy could not call: its `def`, or where none was given."""
        *_, (frame, _) = traceback.walk_tb(error.__traceback__)
        if frame.f_globals.get("__name__") not in ("rclpy.executors", "rclpy.task"):
            return None
        if "object is not callable" in text(error):
            return self._uncallable
        called = frame.f_locals.get("callback")
        code = getattr(getattr(called, "__func__", called), "__code__", None)
        if not isinstance(code, CodeType) or not self._files.has(code.co_filename):
            return None
        is_it = f"{code.co_name}() " in text(error)
        return self._files.row_of(code, code.co_firstlineno) if is_it else None

    def _end(self, what: str, value: object) -> None:
        """Note how it has ended, if that is not known yet, and write the last account."""
        if not self._has_ended:
            self._has_ended = True
            self._note(what, value)
        self._account.write(is_last=True)

    def _note(self, what: str, value: object) -> None:
        if self.row[what] is None:
            self.row[what] = value
            self._account.write()


def error_row(error: BaseException, place: Row | None, now_s: float) -> Row:
    """Return the row of an exception, see `grader.recording.observations.Raised`."""
    what = str(error.code)[:LONGEST] if isinstance(error, SystemExit) else text(error)
    kind = type(error).__name__[:LONGEST]
    return {"type": kind, "text": what, "time_s": now_s, "place": place}
