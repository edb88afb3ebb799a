"""The line between the grader and the simulator's process: a socket that the process inherits.

Where a process inherits nothing (Windows), it calls back over loopback, and says a word by which it
is known. That is over before the submission's process starts.
"""

from __future__ import annotations

import socket
import time
from collections.abc import Callable
from contextlib import suppress
from types import TracebackType
from typing import Self

from grader import system

LOOPBACK = "127.0.0.1"
WORD_BYTES = 32


class Line:
    """Both ends, until the process has the other one; a context that hangs up at its end.

    Attributes:
        word: what the process is told; see `take_up`.
        fds: descriptors that it inherits.
    """

    def __init__(self) -> None:
        self.fds: tuple[int, ...] = ()
        if system.inherits_descriptors():
            self._ours, self._theirs = socket.socketpair()
            self.fds = (self._theirs.fileno(),)
            self.word = str(self._theirs.fileno())
        else:
            import secrets  # takes a while

            self._ours = self._theirs = socket.create_server((LOOPBACK, 0))
            self._known_by = secrets.token_bytes(WORD_BYTES)
            self.word = f"{self._theirs.getsockname()[1]}:{self._known_by.hex()}"

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._theirs.close()
        self._ours.close()

    def connect(self, is_alive: Callable[[], bool], patience_s: float) -> socket.socket:
        """Our end, when the process is started.

        Raises:
            ConnectionError: it had to call, and did not while it lived.
        """
        if self._ours is self._theirs:
            self._ours = self._await_call(is_alive, time.monotonic() + patience_s)
        self._theirs.close()
        return self._ours

    def _await_call(self, is_alive: Callable[[], bool], deadline: float) -> socket.socket:
        self._theirs.settimeout(0.2)
        while time.monotonic() < deadline and is_alive():
            try:
                caller, _ = self._theirs.accept()
            except TimeoutError:
                continue
            if _says(caller, self._known_by):
                caller.settimeout(None)
                return caller
            caller.close()
        raise ConnectionError("nobody called")


def _says(caller: socket.socket, word: bytes) -> bool:
    caller.settimeout(1.0)
    heard = b""
    with suppress(OSError):
        while len(heard) < WORD_BYTES and (more := caller.recv(WORD_BYTES - len(heard))):
            heard += more
    return heard == word


def take_up(word: str) -> socket.socket:
    """In the simulator's process: its end of the line."""
    number, _, known_by = word.partition(":")
    if not known_by:
        return socket.socket(fileno=int(number))
    connection = socket.create_connection((LOOPBACK, int(number)))
    connection.sendall(bytes.fromhex(known_by))
    return connection
