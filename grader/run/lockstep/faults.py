"""Decides whether an exception is the program's, which called something wrongly, or ours.

The innermost frame of its traceback decides. A program's mistake surfaces in its own code, in rclpy
or in Python; one of ours in `grader/run`. Where a program's call goes through our code, the
innermost frame would be ours all the same: rclpy's C++ has no frames, and what we have replaced in
Python must raise what Python raises. Both go through functions of this module, and these are the
only frames of ours that count as the program's: `pass_on` and `as_python_does`.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path
from types import CodeType, TracebackType
from typing import Any, TypeVar

from grader.text.message import Message, msg

_Function = TypeVar("_Function", bound=Callable[..., Any])

#: The folder of all our code that runs in a submission's process.
OURS = str(Path(__file__).parents[1])
#: That of the classes of a hand-in's messages, whose exceptions are the program's.
_MESSAGES = str(Path(__file__).parents[2] / "ros")
#: What loads a submission's program, in real time too.
_LOADER = str(Path(OURS) / "student" / "loading.py")
#: What depends on how much a program has used up, not on whose line is the last.
_NOBODYS = (RecursionError, MemoryError)


def _go_on(_: Message) -> None: ...


#: Called with the answer of `whose` for an exception of ours; in a submission's process it does not
#: return. The simulator's process handles all exceptions in one place, and needs no call.
on_fault: Callable[[Message], None] = _go_on


def pass_on(function: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
    """Call what the program wanted to call, with what it gave; an exception is the program's."""
    return function(*args, **kwargs)


def as_python_does(error: Exception) -> None:
    """Raise what the replaced function of Python or rclpy would raise; it is the program's."""
    raise error


_THE_PROGRAMS: frozenset[CodeType] = frozenset({pass_on.__code__, as_python_does.__code__})


def whose(error: BaseException) -> str:
    """Return '' for an exception of the program's, "TypeError in graph.py, line 12" for ours."""
    trace = error.__traceback__
    if trace is None or not isinstance(error, Exception) or isinstance(error, _NOBODYS):
        return ""
    while trace.tb_next is not None:
        trace = trace.tb_next
    code = trace.tb_frame.f_code
    file = code.co_filename
    if code in _THE_PROGRAMS or file == _LOADER or not is_ours(file):
        return ""
    return f"{type(error).__name__} in {Path(file).name}, line {trace.tb_lineno}"


def failed(error: BaseException) -> Message:
    """Return the sentence for a result's flags."""
    return msg("virtual time itself failed ({where})", where=whose(error) or repr(error))


def report(error: BaseException) -> None:
    """Call `on_fault` if the exception is ours."""
    if whose(error):
        on_fault(failed(error))


def guarded(function: _Function) -> _Function:
    """Wrap a function so that a fault of ours is reported before the program can catch it."""

    @functools.wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        try:
            return function(*args, **kwargs)
        except Exception as error:
            report(error)
            raise

    return call  # type: ignore[return-value]


def guard_methods(kind: type) -> None:
    """Guard all methods that a class defines itself."""
    for name, value in list(vars(kind).items()):
        if callable(value) and not isinstance(value, type):
            setattr(kind, name, guarded(value))


def is_ours(filename: str) -> bool:
    """Whether a file is part of our code that is in a submission's process."""
    return filename.startswith(OURS)


def is_loader(filename: str) -> bool:
    """Whether a file is one of Python's that load programs."""
    return filename.startswith(("<frozen runpy", "<frozen importlib")) or filename.endswith(
        ("/runpy.py", "/importlib/__init__.py")
    )


def hide_our_frames(error: BaseException) -> None:
    """Remove our frames from the tracebacks of an exception and of those that led to it."""
    seen: list[BaseException] = []
    chain: list[BaseException | None] = [error]
    while chain:
        link = chain.pop()
        if link is not None and not any(link is other for other in seen):
            seen.append(link)
            link.__traceback__ = _without_our_frames(link.__traceback__)
            chain += [link.__cause__, link.__context__]


def _without_our_frames(trace: TracebackType | None) -> TracebackType | None:
    frames: list[TracebackType] = []
    while trace is not None:
        file = trace.tb_frame.f_code.co_filename
        if not file.startswith((OURS, _MESSAGES)) and (frames or not is_loader(file)):
            frames.append(trace)
        trace = trace.tb_next
    rest: TracebackType | None = None
    for entry in reversed(frames):
        rest = TracebackType(rest, entry.tb_frame, entry.tb_lasti, entry.tb_lineno)
    return rest
