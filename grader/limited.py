"""Work in a copy of this process, within limits of time and memory: what it breaks ends there.

For code that should come to an end and may not: an author's check, a reader of a file from
anywhere. The copy is a fork, so it has everything that we have, and hands nothing back but bytes.
Whatever happens to it, a loop without end, os._exit, an allocation without measure, a crash in C,
is here a `LimitHit` with a line that says so.

The kernel ends what goes on for too long (SIGPROF, SIGALRM, which nobody handles there), so no loop
in C and no `except BaseException` helps against it. Where there is no fork that can be relied upon
(macOS, Windows) the work is done in this process: then only what Python itself notices is a limit.
"""

from __future__ import annotations

import ctypes
import gc
import os
import select
import signal
import sys
import threading
import time
import traceback
import warnings
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from struct import Struct
from types import TracebackType
from typing import NoReturn, Self

from grader import system
from grader.language.phrase import say

#: A number: of the question, and how long an answer is.
_NUMBER = Struct("<q")
#: What an answer begins with.
_DONE, _HIT = b"=", b"!"
#: So long after its last second the kernel has surely ended a copy [s].
_GRACE_S = 10.0
#: So often it is asked whether it has stalled [s].
_LOOK_S = 0.5
_PR_SET_PDEATHSIG = 1
_ENDING = ("SIGTERM", "SIGHUP", "SIGQUIT", "SIGALRM", "SIGPROF", "SIGXCPU", "SIGPIPE")


@dataclass(frozen=True)
class Limits:
    """How much one answer may take.

    Attributes:
        cpu_s: processor time [s]: a busy machine shortens nothing.
        wall_s: time on the wall clock [s], for what sleeps.
        memory_bytes: more than this process has.
        answer_bytes: the length of the answer.
    """

    cpu_s: float = 20.0
    wall_s: float = 60.0
    memory_bytes: int = 2 * 2**30
    answer_bytes: int = 2**24


#: Made before: who has no memory left makes no sentence.
_TOO_MUCH = say("needed more memory than it may have")
_TOO_DEEP = say("called itself too deeply")


class LimitHit(Exception):
    """The work was ended; the text goes on from its name: 'did not come to an end in 20 s ...'."""


class NoEnd(LimitHit):
    """Its time was over: the processor's or that on the wall, which depends on the machine."""


class Stalled(NoEnd):
    """It waited, and nothing that it had started did anything either."""


class _Slow(NoEnd):
    """The time on the wall is over, though the processor's is not."""


class Copy:
    """A copy of this process, made when it is first asked, that answers by calling a function.

    What the function remembers from one answer to the next, it remembers in the copy.

    Args:
        answer: makes an answer of the number of a question; it raises nothing.
        limits: of each answer.
        is_stalled: asked now and then whether to wait any longer.
    """

    def __init__(
        self,
        answer: Callable[[int], bytes],
        limits: Limits,
        is_stalled: Callable[[], bool] = lambda: False,
    ) -> None:
        self._answer = answer
        self._limits = limits
        self._is_stalled = is_stalled
        self._pid: int | None = None
        self._questions = self._answers = -1

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def ask(self, number: int) -> bytes:
        """The answer to a question.

        Raises:
            LimitHit: there is none; the next question is put to a new copy.
        """
        if not system.runs_submissions():
            return _within_python(self._answer, number)
        try:
            return self._ask(number)
        except _Slow:
            if threading.active_count() == 1:
                raise
            # A fork has the locks that other threads held, and nobody to give them back. That is
            # rare; the same again is not to be expected.
            return self._ask(number)

    def close(self) -> int | None:
        """End the copy, if there is one; how it ended, as `os.waitpid` tells it, if known."""
        if self._pid is None:
            return None
        pid, self._pid = self._pid, None
        os.close(self._questions)
        os.close(self._answers)
        with suppress(ProcessLookupError):
            os.kill(pid, signal.SIGKILL)
        try:
            return os.waitpid(pid, 0)[1]
        except ChildProcessError:  # somebody in this process waits for every child
            return None

    # In this process --------------------------------------------------------------------------

    def _ask(self, number: int) -> bytes:
        if self._pid is None:
            self._fork()
        deadline = time.monotonic() + self._limits.wall_s + _GRACE_S
        try:
            os.write(self._questions, _NUMBER.pack(number))
            head = self._read(1 + _NUMBER.size, deadline)
            (length,) = _NUMBER.unpack(head[1:])
            if not 0 <= length <= self._limits.answer_bytes:
                raise LimitHit(
                    say("answered with more than {size}", size=_mb(self._limits.answer_bytes))
                )
            body = self._read(length, deadline)
        except (EOFError, BrokenPipeError):
            raise self._why_it_ended() from None
        except BaseException:
            self.close()
            raise
        if head[:1] == _HIT:
            raise LimitHit(body.decode())
        return body

    def _read(self, size: int, deadline: float) -> bytes:
        """So many bytes of the answer."""
        waiting = select.poll()
        waiting.register(self._answers, select.POLLIN)
        found = bytearray(size)
        rest = memoryview(found)
        while rest:
            left_s = deadline - time.monotonic()
            if left_s <= 0:
                raise _Slow(
                    say("did not come to an end in {wall_s:g} s", wall_s=self._limits.wall_s)
                )
            if not waiting.poll(min(left_s, _LOOK_S) * 1000):
                if self._is_stalled():
                    raise Stalled(say("waited for what did not come"))
                continue
            count = os.readv(self._answers, [rest])
            if not count:
                raise EOFError
            rest = rest[count:]
        return bytes(found)

    def _why_it_ended(self) -> LimitHit:
        # It has hung up; with time it surely ends, by itself or by the kernel.
        assert self._pid is not None
        status = self._reaped(self._pid)
        self.close()
        if status is None:
            return LimitHit(say("ended the process that it ran in"))
        if os.WIFEXITED(status):
            code = os.WEXITSTATUS(status)
            return LimitHit(
                say("ended the process that it ran in (exit code {code})", code=str(code))
            )
        ended_by = os.WTERMSIG(status)
        if ended_by == signal.SIGPROF:
            return NoEnd(
                say(
                    "did not come to an end in {cpu_s:g} s of processor time",
                    cpu_s=self._limits.cpu_s,
                )
            )
        if ended_by == signal.SIGALRM:
            return _Slow(say("did not come to an end in {wall_s:g} s", wall_s=self._limits.wall_s))
        return LimitHit(
            say("ended the process that it ran in (signal {signal})", signal=str(ended_by))
        )

    def _reaped(self, pid: int) -> int | None:
        """How a copy that has hung up ended; None: it has not, or nobody knows."""
        deadline = time.monotonic() + _GRACE_S
        with suppress(ChildProcessError):
            while time.monotonic() < deadline:
                found, status = os.waitpid(pid, os.WNOHANG)
                if found:
                    return status
                time.sleep(0.001)
        return None

    def _fork(self) -> None:
        theirs, self._questions = os.pipe()
        self._answers, ours = os.pipe()
        for stream in (sys.stdout, sys.stderr):
            with suppress(AttributeError, OSError, ValueError):  # there may be none
                stream.flush()
        with warnings.catch_warnings():
            # Of forking beside other threads; see `ask`.
            warnings.simplefilter("ignore", DeprecationWarning)
            self._pid = os.fork()
        if self._pid == 0:
            self._be_copy(theirs, ours)
        os.close(theirs)
        os.close(ours)

    # In the copy ------------------------------------------------------------------------------

    def _be_copy(self, questions: int, answers: int) -> NoReturn:
        code, copy = 1, os.getpid()
        try:
            gc.freeze()  # to look through all that is inherited would copy it, and might end it
            _confine(self._limits, (questions, answers))
            _print_to_standard_error()
            while len(question := os.read(questions, _NUMBER.size)) == _NUMBER.size:
                signal.setitimer(signal.ITIMER_PROF, self._limits.cpu_s)
                signal.setitimer(signal.ITIMER_REAL, self._limits.wall_s)
                try:
                    mark, body = _DONE, _within_python(self._answer, _NUMBER.unpack(question)[0])
                except LimitHit as hit:
                    mark, body = _HIT, str(hit).encode()
                if os.getpid() != copy:
                    os._exit(1)  # the work has forked, and this one is no copy that was asked
                signal.setitimer(signal.ITIMER_PROF, 0)
                signal.setitimer(signal.ITIMER_REAL, 0)
                with suppress(AttributeError, OSError, ValueError):
                    sys.stderr.flush()
                _write(answers, mark + _NUMBER.pack(len(body)) + body)
            code = 0
        except BaseException:
            traceback.print_exc()
        finally:
            os._exit(code)


def call(
    work: Callable[[], bytes], limits: Limits, is_stalled: Callable[[], bool] = lambda: False
) -> bytes:
    """What one call of a function returns, within limits; see `Copy`.

    Raises:
        LimitHit: it returned nothing.
    """
    with Copy(lambda _: work(), limits, is_stalled) as copy:
        return copy.ask(0)


def _within_python(answer: Callable[[int], bytes], number: int) -> bytes:
    """An answer, or the limits that Python itself notices."""
    try:
        return answer(number)
    except MemoryError:
        raise LimitHit(_TOO_MUCH) from None
    except RecursionError:
        raise LimitHit(_TOO_DEEP) from None


def _confine(limits: Limits, kept: Iterable[int]) -> None:
    """Nothing of what this copy does reaches further than itself, or lasts."""
    import resource  # here: Windows has none

    for name in _ENDING:
        signal.signal(getattr(signal, name), signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is told to the one who asks, too
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGALRM, signal.SIGPROF})
    with suppress(AttributeError, OSError):
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    # Whoever waits for the other end of one of our sockets is not to wait for this copy.
    for path in list((system.PROC / "self" / "fd").iterdir()):
        if int(path.name) > 2 and int(path.name) not in kept:
            with suppress(OSError):
                os.close(int(path.name))
    pages = int((system.PROC / "self" / "statm").read_text(encoding="ascii").split()[0])
    most = pages * resource.getpagesize() + limits.memory_bytes
    for what, value in ((resource.RLIMIT_AS, most), (resource.RLIMIT_CORE, 0)):
        soft, hard = resource.getrlimit(what)
        bounds = [bound for bound in (soft, hard, value) if bound != resource.RLIM_INFINITY]
        resource.setrlimit(what, (min(bounds), hard))


def _print_to_standard_error() -> None:
    """Standard output may be a result that a program reads, and our caller's objects are copies."""
    with suppress(OSError):  # it may be closed
        os.dup2(2, 1)
        sys.stdout = sys.stderr = open(  # noqa: SIM115  as long as the copy lasts
            2, "w", buffering=1, encoding="utf-8", errors="backslashreplace", closefd=False
        )


def _write(descriptor: int, data: bytes) -> None:
    view = memoryview(data)
    while view:
        view = view[os.write(descriptor, view) :]


def _mb(size: int) -> str:
    return f"{size / 2**20:.0f} MB"
