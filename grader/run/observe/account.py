"""The account that a submission's process keeps of itself, in a page that the grader has as well.

The page is a memfd of fixed size that the grader has made and sealed. It begins with the tick that
virtual time has reached (`grader.run.lockstep.protocol`). The next two parts are written in turns:
a number, the length and the checksum of what follows, JSON. A reader uses the newest whole one, so
a process may be killed at any moment. Into the last part Python's faulthandler writes where the
threads are. The submission may have written any of it: `grader.run.evidence` checks it.
"""

from __future__ import annotations

import binascii
import faulthandler
import fcntl
import json
import os
import signal
from _thread import allocate_lock
from collections.abc import Callable
from contextlib import suppress
from struct import Struct
from typing import Any

from grader.run.lockstep.protocol import PROGRESS_BYTES

#: Checksum, number, length; whether there will be no other.
_HEAD = Struct("<IQI?3x")
HALF_BYTES, DUMP_BYTES = 49_152, 65_536
MOST_BYTES = HALF_BYTES - _HEAD.size
#: Where the two halves begin, and the dump.
HALVES, DUMP = (PROGRESS_BYTES, PROGRESS_BYTES + HALF_BYTES), PROGRESS_BYTES + 2 * HALF_BYTES
_SEALS = fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_SEAL
#: Where there is no room these are left out, in this order; the ends come last.
CUT = ("ran", "slow", "timers", "caught", "waits")
#: At this signal a process dumps where its threads are: one that no program uses, and that needs
#: no handler in Python. It works also where a program computes without end, or waits in C.
DUMP_SIGNAL = signal.SIGRTMIN + 9

# In the grader's process ----------------------------------------------------------------------


def make() -> int:
    """Return an open page, positioned where a dump begins."""
    page = os.memfd_create("account", os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    os.ftruncate(page, DUMP + DUMP_BYTES)
    fcntl.fcntl(page, fcntl.F_ADD_SEALS, _SEALS)
    os.lseek(page, DUMP, os.SEEK_SET)
    return page


def read(page: int) -> tuple[bytes, bool]:
    """Return the newest account that is whole, and whether it is the last."""
    found = [(0, b"", False)]
    for begin in HALVES:
        half = os.pread(page, HALF_BYTES, begin)
        checksum, number, length, is_last = _HEAD.unpack_from(half)
        data = half[_HEAD.size : _HEAD.size + length]
        if len(data) == length and checksum == _checksum(number, data):
            found.append((number, data, is_last))
    return max(found)[1:]


def dumped(page: int) -> bytes:
    return os.pread(page, DUMP_BYTES, DUMP).partition(b"\0")[0]


# In the submission's process ------------------------------------------------------------------


class ProcessAccount:
    """The account of this process, kept up to date."""

    def __init__(self, page: int, summary: Callable[[], dict[str, Any]]) -> None:
        """Keep what `summary` returns in the page of this descriptor; -1: nowhere."""
        self._page, self._process = page, os.getpid()
        self._summary = summary
        self._identity = _identity(page)
        self._lock = allocate_lock()
        self._number = 0
        self._changes, self._next = 0, 0
        if page >= 0:
            os.set_inheritable(page, False)

    def dump_when_asked(self) -> None:
        """Have all threads dumped at the signal, and where the process dies by a fault in C."""
        if self._page < 0:
            return
        with suppress(OSError, RuntimeError, ValueError):
            faulthandler.register(DUMP_SIGNAL, self._page, all_threads=True)
        with suppress(OSError, RuntimeError, ValueError):
            faulthandler.enable(self._page)

    def changed(self) -> None:
        """Write it after a change, ever less often the more changes there are."""
        self._changes += 1
        if self._changes >= self._next:
            self.write()

    def write(self, *, is_last: bool = False) -> None:
        """Write it now: it has a new entry, or this process may be ended before the next change."""
        self._next = self._changes * 5 // 4 + 1
        if self._is_another() or not self._lock.acquire(timeout=1.0 if is_last else 0):
            return
        try:
            data = _fitting(self._summary())
            self._number += 1
            head = _HEAD.pack(_checksum(self._number, data), self._number, len(data), is_last)
            with suppress(OSError):
                os.pwrite(self._page, head + data, HALVES[self._number % 2])
        finally:
            self._lock.release()

    def _is_another(self) -> bool:
        """Whether this is a fork, or the program has closed the page and opened something else."""
        if self._page < 0 or os.getpid() != self._process:
            return True
        return _identity(self._page) != self._identity


def _identity(descriptor: int) -> tuple[int, int]:
    try:
        found = os.fstat(descriptor)
    except OSError:
        return 0, 0
    return found.st_dev, found.st_ino


def _checksum(number: int, data: bytes) -> int:
    return binascii.crc32(data, number & 0xFFFFFFFF)


def _fitting(summary: dict[str, Any]) -> bytes:
    """Return a summary as JSON, as much of it as there is room for."""
    for name in CUT:
        if len(data := _bytes(summary)) <= MOST_BYTES:
            return data
        summary[name] = []
    while len(data := _bytes(summary)) > MOST_BYTES and summary["ends"]:
        del summary["ends"][len(summary["ends"]) // 2 :]
    return data


def _bytes(summary: dict[str, Any]) -> bytes:
    return json.dumps(summary).encode("ascii")


def quietly(function: Callable[..., Any], *args: Any) -> Any:
    """Call a function; return None where it fails, so that the program never sees its error."""
    try:
        return function(*args)
    except Exception:
        return None
