"""The account that a submission's process keeps of itself, in a page that the grader has as well.

The page is a memfd of fixed size that the grader has made and sealed. Its first two parts are
written in turns: a number, the length and the checksum of what follows, JSON. Whoever reads takes
the newest that is whole, so a process may be killed at any moment. Into the last part Python's
faulthandler writes where the threads are. Who writes may be anybody: `grader.run.evidence` says
what may stand there.
"""

from __future__ import annotations

import binascii
import fcntl
import json
import os
from _thread import allocate_lock
from collections.abc import Callable
from contextlib import suppress
from struct import Struct
from typing import Any

#: Checksum, number, length; whether there will be no other.
_HEAD = Struct("<IQI?3x")
HALF_BYTES, DUMP_BYTES = 49_152, 65_536
MOST_BYTES = HALF_BYTES - _HEAD.size
SIZE = 2 * HALF_BYTES + DUMP_BYTES
_SEALS = fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_SEAL
#: Where there is no room for all of it these are left out, in this order; the ends come last.
CUT = ("slow", "timers", "caught", "waits")


def make() -> int:
    """In the grader's process: an open page, in which a dump would begin in its place."""
    page = os.memfd_create("account", os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
    os.ftruncate(page, SIZE)
    fcntl.fcntl(page, fcntl.F_ADD_SEALS, _SEALS)
    os.lseek(page, 2 * HALF_BYTES, os.SEEK_SET)
    return page


def read(page: int) -> tuple[bytes, bool]:
    """In the grader's process: the newest account that is whole, and whether it is the last."""
    found = [(0, b"", False)]
    for begin in (0, HALF_BYTES):
        half = os.pread(page, HALF_BYTES, begin)
        checksum, number, length, is_last = _HEAD.unpack_from(half)
        data = half[_HEAD.size : _HEAD.size + length]
        if len(data) == length and checksum == _checksum(number, data):
            found.append((number, data, is_last))
    return max(found)[1:]


def dumped(page: int) -> bytes:
    """In the grader's process: what was dumped."""
    return os.pread(page, DUMP_BYTES, 2 * HALF_BYTES).partition(b"\0")[0]


class Account:
    """It, kept up to date.

    Args:
        page: its descriptor; -1: nobody reads.
    """

    def __init__(self, page: int) -> None:
        self._page, self._process = page, os.getpid()
        self._identity = _identity(page)
        self._lock = allocate_lock()
        self._number = 0
        self._changes, self._next = 0, 0
        #: what it holds, as JSON has it
        self.tell: Callable[[], dict[str, Any]] = dict

    def changed(self) -> None:
        """Something in it has: it is written, ever less often the more often this comes."""
        self._changes += 1
        if self._changes >= self._next:
            self.write()

    def write(self, *, is_last: bool = False) -> None:
        """Write it now: something is new in it, or this process may be ended before the next."""
        self._next = self._changes * 5 // 4 + 1
        if self._is_another() or not self._lock.acquire(timeout=1.0 if is_last else 0):
            return
        try:
            data = _fitting(self.tell())
            self._number += 1
            head = _HEAD.pack(_checksum(self._number, data), self._number, len(data), is_last)
            with suppress(OSError):
                os.pwrite(self._page, head + data, HALF_BYTES * (self._number % 2))
        finally:
            self._lock.release()

    def _is_another(self) -> bool:
        """Whether this is a fork, or the program has closed the page and opened something else."""
        return (
            self._page < 0
            or os.getpid() != self._process
            or _identity(self._page) != self._identity
        )


def _identity(descriptor: int) -> tuple[int, int]:
    try:
        found = os.fstat(descriptor)
    except OSError:
        return 0, 0
    return found.st_dev, found.st_ino


def _checksum(number: int, data: bytes) -> int:
    return binascii.crc32(data, number & 0xFFFFFFFF)


def _fitting(account: dict[str, Any]) -> bytes:
    """All of it that there is room for."""
    for name in CUT:
        if len(data := _bytes(account)) <= MOST_BYTES:
            return data
        account[name] = []
    while len(data := _bytes(account)) > MOST_BYTES and account["ends"]:
        del account["ends"][len(account["ends"]) // 2 :]
    return data


def _bytes(account: dict[str, Any]) -> bytes:
    return json.dumps(account).encode("ascii")
