"""Notes which lines of a submission have run, and what its conditions were asked about.

Python calls a trace function at each call and each line of a thread, which costs more than the line
itself. So it is off while an executor spins, apart from callbacks; a function whose lines have all
run is followed no more; and after so many lines nothing is.
"""

from __future__ import annotations

import re
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from enum import Enum
from types import CodeType, FrameType, MemberDescriptorType
from typing import Any

from grader.run.observe.files import Row, SubmissionFiles

#: So many lines are followed, conditions asked for values, exceptions kept.
MOST_LINES, MOST_ASKED, MOST_RAISED = 300_000, 60, 10
#: The longest value, and all of a condition [characters].
LONGEST_VALUE, LONGEST = 40, 120
_CONDITION = re.compile(r"\s*(?:(?:el)?if|while)\b(.*)")
_NAME = re.compile(r"(?<![\w.'\"])[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)?(?![\w.(])")
_PLAIN = (bool, int, float, str, type(None))

Trace = Callable[[FrameType, str, Any], Any]


class LineTrace:
    """Follows the lines of a submission's files in the threads that ask for it."""

    def __init__(self, files: SubmissionFiles) -> None:
        self._files = files
        #: lines of each function that have not run yet, and all that it has
        self._left: dict[CodeType, set[int]] = {}
        self._all: dict[CodeType, set[int]] = {}
        self._conditions: dict[tuple[CodeType, int], tuple[str, ...]] = {}
        self._asked: dict[tuple[str, int], str] = {}
        self._times: dict[tuple[CodeType, int], int] = {}
        #: the first exception that came to each line
        self._raised: dict[tuple[str, int], str] = {}
        self._count = 0
        self._follow: Trace = self._line

    def begin(self) -> None:
        """Follow this thread, and those that it starts."""
        threading.settrace(self._call)
        sys.settrace(self._call)

    def within(self, call: Callable[..., Any], *args: Any) -> Any:
        """Call a callback, followed."""
        return _with(self._call if self._count < MOST_LINES else None, call, *args)

    def discard(self) -> None:
        """Note that some lines are not followed, so that none of them counts."""
        self._count = MOST_LINES

    def rows(self) -> list[Row]:
        """Return the entry of each file in the account; [] where some lines were not followed."""
        if self._count >= MOST_LINES:
            return []
        ran: dict[str, set[int]] = {}
        for code, lines in list(self._all.items()):
            if lines:
                ran.setdefault(self._files.name(code.co_filename), set()).update(
                    lines - self._left[code]
                )
        return [
            {
                "file": file,
                "lines": sorted(lines),
                "asked": _of(file, self._asked),
                "raised": _of(file, self._raised),
            }
            for file, lines in ran.items()
        ]

    def _call(self, frame: FrameType, event: str, argument: object) -> Trace | None:
        code = frame.f_code
        left = self._left.get(code)
        if left is None:
            left = self._begin(code)
        return self._follow if left else None

    def _line(self, frame: FrameType, event: str, argument: object) -> Trace | None:
        if event == "line":
            self._count += 1
            if self._count >= MOST_LINES:
                sys.settrace(None)
                return None
            code, line = frame.f_code, frame.f_lineno
            self._left[code].discard(line)
            if (code, line) in self._conditions:
                self._ask(frame, code, line)
        elif event == "exception" and isinstance(argument, tuple):
            self._note(frame, argument[0], argument[1])
        return self._follow

    def _begin(self, code: CodeType) -> set[int]:
        lines = set[int]()
        if self._files.has(code.co_filename):
            lines = {line for *_, line in code.co_lines() if line}
            texts = self._files.lines(code.co_filename)
            for line in lines:
                found = _CONDITION.match(texts[line - 1]) if line <= len(texts) else None
                if found and (names := tuple(dict.fromkeys(_NAME.findall(found[1])))):
                    self._conditions[code, line] = names[:4]
        self._all[code], self._left[code] = lines, set(lines)
        return self._left[code]

    def _ask(self, frame: FrameType, code: CodeType, line: int) -> None:
        """Keep the values of a condition's names: of its first time, its second, its fourth."""
        times = self._times[code, line] = self._times.get((code, line), 0) + 1
        key = self._files.name(code.co_filename), line
        if times & (times - 1) or (key not in self._asked and len(self._asked) >= MOST_ASKED):
            return
        values = ((name, _value(frame, name)) for name in self._conditions[code, line])
        found = ", ".join(f"{name} = {value}" for name, value in values if value)
        self._asked[key] = found[:LONGEST]

    def _note(self, frame: FrameType, kind: type, error: object) -> None:
        """Keep an exception of Python's own: another's text may be the submission's code."""
        key = self._files.name(frame.f_code.co_filename), frame.f_lineno
        is_known = kind.__module__ == "builtins" and kind.__name__.endswith("Error")
        if is_known and key not in self._raised and len(self._raised) < MOST_RAISED:
            with suppress(Exception):
                self._raised[key] = f"{kind.__name__}: {error}"[:LONGEST]


def _of(file: str, texts: dict[tuple[str, int], str]) -> list[Row]:
    return [{"line": line, "text": text} for (name, line), text in [*texts.items()] if name == file]


def unfollowed(call: Callable[..., Any], *args: Any) -> Any:
    """Call a function that spins."""
    return _with(None, call, *args)


def _with(trace: Trace | None, call: Callable[..., Any], *args: Any) -> Any:
    before = sys.gettrace()
    sys.settrace(trace)
    try:
        return call(*args)
    finally:
        sys.settrace(before)


def _value(frame: FrameType, name: str) -> str:
    """Return a name's value as text, without running any code of the submission's; '' for none."""
    head, _, attribute = name.partition(".")
    with suppress(Exception):
        value = frame.f_locals[head] if head in frame.f_locals else frame.f_globals[head]
        if attribute:
            slot = type(value).__dict__.get(f"_{attribute}")  # a field of a message
            if isinstance(slot, MemberDescriptorType):
                value = slot.__get__(value)
            else:
                value = object.__getattribute__(value, "__dict__")[attribute]
        if isinstance(value, Enum):
            return f"{type(value).__name__}.{value._name_}"[:LONGEST_VALUE]
        parts = value if type(value) in (tuple, list) else [value]
        if all(type(part) in _PLAIN for part in parts[:4]) and len(parts) <= 4:
            shown = f"{value:.4g}" if type(value) is float else repr(value)
            return shown if len(shown) <= LONGEST_VALUE else ""
    return ""
