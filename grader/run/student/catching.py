"""Exceptions of callbacks that do not end the program.

Those that leave a callback are seen each time. One that an `except` in it catches is seen where the
call is traced: the first calls, and then ever fewer, because tracing takes time of the machine.
"""

from __future__ import annotations

import sys
import threading
from dataclasses import dataclass
from types import CodeType, FrameType, TracebackType
from typing import Any

from grader.run.student import telling
from grader.run.student.telling import Teller

#: So many calls are traced, and after them each whose number is a power of two.
FIRST_CALLS = 24
MOST = 20
#: How a program is ended, and what a loop ends with.
NO_ERRORS = ("KeyboardInterrupt", "ExternalShutdownException", "StopIteration", "GeneratorExit")


@dataclass
class Caught:
    """An exception; see `grader.recording.conduct.Caught`."""

    told: dict[str, Any]
    times: int = 0


class Catching:
    """What has been seen; whoever runs a callback says when it begins and ends."""

    def __init__(self, teller: Teller) -> None:
        self._teller = teller
        self._calls = 0
        self._seen: dict[tuple[str, CodeType, int], Caught] = {}

    def begin(self) -> Tracing | None:
        """A callback begins; what is to be ended with it."""
        self._calls += 1
        is_looked_at = self._calls <= FIRST_CALLS or not self._calls & (self._calls - 1)
        if not is_looked_at or sys.gettrace() is not None or threading.gettrace() is not None:
            return None
        tracing = Tracing(self._teller)
        sys.settrace(tracing.enters)
        return tracing

    def end(self, tracing: Tracing | None, left_by: BaseException | None) -> None:
        """It has ended.

        Args:
            left_by: the exception that has left it.
        """
        if tracing is not None:
            if sys.gettrace() == tracing.enters:  # else the program traces by itself now
                sys.settrace(None)
            for error, trace, by in tracing.caught.values():
                self._add(error, trace, by)
        if isinstance(left_by, Exception):
            self._add(left_by, left_by.__traceback__, None)

    def _add(
        self, error: BaseException, trace: TracebackType | None, by: dict[str, Any] | None
    ) -> None:
        lines = telling.trace(trace)
        at = self._teller.own(lines)
        kind = type(error).__name__[: telling.LONGEST]
        if at < 0 or kind in NO_ERRORS:
            return
        where = lines[at][0].f_code, lines[at][1]
        seen = self._seen.get((kind, *where))
        if seen is None:
            if len(self._seen) >= MOST:
                return
            told = {"type": kind, "text": telling.text(error), "time_s": self._teller.now_s()}
            told |= {"place": self._teller.line(*where), "by": by}
            seen = self._seen[(kind, *where)] = Caught(told)
        seen.times += 1
        if seen.times == 1:
            self._teller.account.write()
        self._teller.account.changed()

    def told(self) -> list[dict[str, Any]]:
        """All that were seen."""
        return [{**seen.told, "times": seen.times} for seen in list(self._seen.values())]


class Tracing:
    """One call of a callback, which Python tells of step by step.

    Attributes:
        caught: exceptions after which the function that they came to went on, in an `except`.
    """

    def __init__(self, teller: Teller) -> None:
        self._teller = teller
        self._raised: dict[FrameType, tuple[BaseException, TracebackType]] = {}
        self.caught: dict[int, tuple[BaseException, TracebackType, dict[str, Any]]] = {}

    def enters(self, frame: FrameType, event: str, _: Any) -> Any:
        """A function begins: the submission's own are followed."""
        return self._goes_on if self._teller.is_own(frame.f_code.co_filename) else None

    def _goes_on(self, frame: FrameType, event: str, value: Any) -> Any:
        if event == "exception":
            _, error, trace = value
            if isinstance(error, BaseException):
                self.caught.pop(id(error), None)  # it was raised again
                self._raised[frame] = error, trace
        elif event == "line" and frame in self._raised:
            error, trace = self._raised.pop(frame)
            number = _except(self._teller.source(frame.f_code.co_filename), frame.f_lineno)
            if number:
                self.caught[id(error)] = error, trace, self._teller.line(frame.f_code, number)
        elif event == "return":
            self._raised.pop(frame, None)
        return self._goes_on


def _except(lines: list[str], number: int) -> int:
    """The line of the `except` that a line is in, or is itself; 0 for none."""
    indent = -1
    for at in range(min(number, len(lines)), 0, -1):
        text = lines[at - 1].expandtabs()
        word = text.strip()
        blanks = len(text) - len(text.lstrip())
        if not word or word.startswith("#"):
            continue
        if word.startswith("except") and (indent < 0 or blanks < indent):
            return at
        if 0 <= indent <= blanks:
            continue
        if indent >= 0:  # another block's head
            return 0
        indent = blanks
    return 0
