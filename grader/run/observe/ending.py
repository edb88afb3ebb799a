"""Observes how a submission's process has ended, or where it is stuck."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from traceback import walk_tb
from types import CodeType
from typing import Any

from grader.run.observe import stuck
from grader.run.observe.account import ProcessAccount, quietly
from grader.run.observe.files import LONGEST, Frame, Row, SubmissionFiles, text


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
        found = stuck.deadlock(stacks)
        if found is not None:
            print(stuck.explain(*found, self._now_s()), file=sys.stderr, flush=True)
        elif any(stuck.in_spin(frame) for stack in stacks for frame in stack):
            return False
        stop = stuck.called(*(found or ("call", self._stack(main))))
        if stop is not None:
            self._end("stop", stop.row(self._files, self._now_s()))
        return found is not None

    def over(self, main: int) -> None:
        """Note the end of the run; the program would have gone on. `main`: its main thread."""
        if not self._has_ended:
            found = quietly(lambda: stuck.at_end(self._stack(main)))
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
        last = stuck.last_line(self._files.trace(error))
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
        *_, (frame, _) = walk_tb(error.__traceback__)
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
