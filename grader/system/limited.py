"""Work in a copy of this process, within limits of time and memory: what it breaks ends there.

For code that may never end: an author's checks, a reader of a file from anywhere. The copy is a
fork of this process and not of a fork server, so it has everything that we have: the exercise, a
recording, a function. It returns nothing but bytes. Whatever happens to it, a loop without end,
os._exit, a huge allocation, a crash in C, is here a `LimitHit` with the reason.

The kernel ends what takes too long (SIGPROF, SIGALRM, which have no handlers there), so no loop in
C and no `except BaseException` helps against it. Where submissions are not run (macOS, Windows) the
work is done in this process: then only what Python itself notices is a limit.
"""

from __future__ import annotations

import gc
import json
import os
import select
import signal
import sys
import time
import traceback
import warnings
from collections.abc import Callable, Generator, Iterator
from contextlib import closing, redirect_stdout, suppress
from dataclasses import dataclass
from struct import Struct
from typing import NoReturn

from grader.system import versions as system
from grader.text.message import Message, msg

#: Before each answer: its mark (an answer, a hit limit, the end), and its length.
_HEAD = Struct("<cq")
_ANSWER, _HIT, _END = b"=", b"!", b"."
#: So long after its limit the kernel has surely ended a copy [s].
_GRACE_S = 10.0
#: How often a copy is checked for a stall [s].
_STALL_CHECK_S = 0.5
#: How much memory this process had when that could be read last [bytes].
_size = 0
_ENDING = ("SIGTERM", "SIGHUP", "SIGQUIT", "SIGALRM", "SIGPROF", "SIGXCPU", "SIGPIPE")


@dataclass(frozen=True)
class WorkLimits:
    """How much a copy may use.

    Attributes:
        cpu_s: processor time [s]: a busy machine shortens nothing.
        wall_s: time on the wall clock [s], for what sleeps.
        memory_bytes: more than this process has.
        answer_bytes: the length of one answer.
    """

    cpu_s: float = 20.0
    wall_s: float = 60.0
    memory_bytes: int = 2 * 2**30
    answer_bytes: int = 2**24


#: Made before: without memory no sentence can be made.
TOO_MUCH = msg("needed more memory than it may have")
TOO_DEEP = msg("called itself too deeply")
_SERIALISED = {each: json.dumps(each.serialise()).encode() for each in (TOO_MUCH, TOO_DEEP)}


class LimitHit(Exception):
    """The work was ended; `why` goes on from its name: 'did not come to an end in 20 s ...'."""

    def __init__(self, why: Message) -> None:
        super().__init__(why)
        self.why = why


class NoEnd(LimitHit):
    """Its time was over, on the processor or on the wall clock."""


class Stalled(NoEnd):
    """It waited, and the caller saw that it would wait for ever."""


class Slow(NoEnd):
    """Its time on the wall clock was over, which depends on the machine."""


Work = Callable[[], Iterator[bytes]]


def stream(
    work: Work, limits: WorkLimits, is_stalled: Callable[[], bool] = lambda: False
) -> Generator[bytes]:
    """Yield the answers of a generator in a copy of this process, each as it is made.

    A fork inherits locks that other threads held, and would wait for one for ever: the generator
    must need none that another thread acquires.

    Args:
        limits: of the whole work.
        is_stalled: called now and then; True ends the work.

    Raises:
        LimitHit: there are no more, while iterating.
    """
    if not system.runs_submissions():
        with redirect_stdout(sys.stderr):  # else it may be a result that a program reads
            made = list(_within_python(work))
        yield from made
        return
    with closing(_Copy(work, limits)) as copy:
        yield from copy.answers(is_stalled)


def call(
    work: Callable[[], bytes], limits: WorkLimits, is_stalled: Callable[[], bool] = lambda: False
) -> bytes:
    """Return what a function returns, within limits; see `stream`.

    Raises:
        LimitHit: it returned nothing.
    """
    with closing(stream(lambda: iter([work()]), limits, is_stalled)) as answers:
        return next(answers)


def _within_python(work: Work) -> Iterator[bytes]:
    """Yield the answers; turn what Python itself notices into hit limits."""
    try:
        yield from work()
    except MemoryError:
        raise LimitHit(TOO_MUCH) from None
    except RecursionError:
        raise LimitHit(TOO_DEEP) from None


class _Copy:
    """A copy of this process that works until it is closed."""

    def __init__(self, work: Work, limits: WorkLimits) -> None:
        self._limits = limits
        self._has_ended = False
        self._answers, ours = os.pipe()
        for output in (sys.stdout, sys.stderr):
            with suppress(AttributeError, OSError, ValueError):  # there may be none
                output.flush()
        size = _size_bytes()
        with warnings.catch_warnings():
            # Of forking beside other threads; see `stream`.
            warnings.simplefilter("ignore", DeprecationWarning)
            self._pid = os.fork()
        if self._pid == 0:
            _be_copy(work, limits, ours, size)
        os.close(ours)

    def answers(self, is_stalled: Callable[[], bool]) -> Iterator[bytes]:
        """Yield all answers.

        Raises:
            LimitHit: there are no more.
        """
        deadline = time.monotonic() + self._limits.wall_s + _GRACE_S
        while True:
            try:
                mark, length = _HEAD.unpack(self._read(_HEAD.size, deadline, is_stalled))
                if not 0 <= length <= self._limits.answer_bytes:
                    size = f"{self._limits.answer_bytes / 2**20:.0f} MB"
                    raise LimitHit(msg("answered with more than {size}", size=size))
                body = self._read(length, deadline, is_stalled)
            except EOFError:
                raise self._why_it_ended() from None
            if mark == _HIT:
                raise LimitHit(Message.parse(json.loads(body)))
            if mark == _END:
                return
            yield body

    def close(self) -> None:
        os.close(self._answers)
        if not self._has_ended:  # else its process id may be in use again
            with suppress(ProcessLookupError):
                os.kill(self._pid, signal.SIGKILL)
            with suppress(ChildProcessError):  # other code here may wait for every child
                os.waitpid(self._pid, 0)

    def _read(self, size: int, deadline: float, is_stalled: Callable[[], bool]) -> bytes:
        waiting = select.poll()
        waiting.register(self._answers, select.POLLIN)
        found = bytearray(size)
        rest = memoryview(found)
        while rest:
            left_s = max(0.0, deadline - time.monotonic())
            if not waiting.poll(min(left_s, _STALL_CHECK_S) * 1000):
                if not left_s:
                    raise Slow(
                        msg("did not come to an end in {wall_s:g} s", wall_s=self._limits.wall_s)
                    )
                if is_stalled():
                    raise Stalled(msg("waited for what did not come"))
                continue
            count = os.readv(self._answers, [rest])
            if not count:
                raise EOFError
            rest = rest[count:]
        return bytes(found)

    def _why_it_ended(self) -> LimitHit:
        # It has closed its pipe; soon it surely ends, by itself or by the kernel.
        status = self._reaped()
        if status is None:
            return LimitHit(msg("ended the process that it ran in"))
        if os.WIFEXITED(status):
            code = str(os.WEXITSTATUS(status))
            return LimitHit(msg("ended the process that it ran in (exit code {code})", code=code))
        ended_by = os.WTERMSIG(status)
        if ended_by == signal.SIGPROF:
            return NoEnd(
                msg(
                    "did not come to an end in {cpu_s:g} s of processor time",
                    cpu_s=self._limits.cpu_s,
                )
            )
        if ended_by == signal.SIGALRM:
            return Slow(msg("did not come to an end in {wall_s:g} s", wall_s=self._limits.wall_s))
        return LimitHit(
            msg("ended the process that it ran in (signal {signal})", signal=str(ended_by))
        )

    def _reaped(self) -> int | None:
        """Return the status of a copy that has closed its pipe; None where it is unknown."""
        deadline = time.monotonic() + _GRACE_S
        with suppress(ChildProcessError):
            while time.monotonic() < deadline:
                found, status = os.waitpid(self._pid, os.WNOHANG)
                if found:
                    self._has_ended = True
                    return status
                time.sleep(0.001)
        return None


# In the copy ----------------------------------------------------------------------------------


def _be_copy(work: Work, limits: WorkLimits, answers: int, size_bytes: int) -> NoReturn:
    code, copy = 1, os.getpid()
    try:
        gc.freeze()  # searching all that is inherited for garbage would copy it, and use memory
        _confine(limits, answers, size_bytes)
        _print_to_standard_error()
        signal.setitimer(signal.ITIMER_PROF, limits.cpu_s)
        signal.setitimer(signal.ITIMER_REAL, limits.wall_s)
        try:
            for answer in _within_python(work):
                if os.getpid() != copy:
                    os._exit(1)  # the work has forked, and this is the fork
                _write(answers, _HEAD.pack(_ANSWER, len(answer)) + answer)
            last, why = _END, b""
        except LimitHit as hit:
            last, why = _HIT, _SERIALISED.get(hit.why) or json.dumps(hit.why.serialise()).encode()
        with suppress(AttributeError, OSError, ValueError):
            sys.stderr.flush()
        if os.getpid() == copy:
            _write(answers, _HEAD.pack(last, len(why)) + why)
        code = 0
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(code)


def _size_bytes() -> int:
    """Return how much memory this process has, as far as `RLIMIT_AS` counts it."""
    global _size
    with suppress(PermissionError):  # a copy may not read that at `landlock`: as it was before
        text = (system.PROC / "self" / "statm").read_text(encoding="ascii")
        _size = int(text.split()[0]) * os.sysconf("SC_PAGE_SIZE")
    return _size


def _confine(limits: WorkLimits, kept: int, size_bytes: int) -> None:
    """Keep the effects of this copy to itself, and set its limits; it had that size."""
    import resource  # here: Windows has none

    from grader.system import linux

    for name in _ENDING:
        signal.signal(getattr(signal, name), signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches our caller, too
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGALRM, signal.SIGPROF})
    linux.signal_at_parents_death(signal.SIGKILL)
    # A process that waits for the end of one of our sockets is not to wait for this copy.
    linux.close_descriptors((0, 1, 2, kept))
    most = size_bytes + limits.memory_bytes
    linux.lower_limit(resource.RLIMIT_AS, most, resource.RLIM_INFINITY)
    linux.lower_limit(resource.RLIMIT_CORE, 0, resource.RLIM_INFINITY)


def _print_to_standard_error() -> None:
    """Redirect standard output, which may be a result that a program reads, to standard error."""
    with suppress(OSError):  # it may be closed
        os.dup2(2, 1)
        sys.stdout = sys.stderr = open(  # noqa: SIM115  as long as the copy lasts
            2, "w", buffering=1, encoding="utf-8", errors="backslashreplace", closefd=False
        )


def _write(descriptor: int, data: bytes) -> None:
    view = memoryview(data)
    while view:
        view = view[os.write(descriptor, view) :]
