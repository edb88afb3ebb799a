"""The line between the grader and the simulator's process: a socket that the process inherits."""

from __future__ import annotations

import socket
from types import TracebackType
from typing import Self


class Line:
    """Both ends, until the process has the other one; a context that hangs up at its end.

    Attributes:
        word: what the process is told; see `take_up`.
        fds: descriptors that it inherits.
    """

    def __init__(self) -> None:
        self._ours, self._theirs = socket.socketpair()
        self.fds = (self._theirs.fileno(),)
        self.word = str(self._theirs.fileno())

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

    def connect(self) -> socket.socket:
        """Our end, when the process is started."""
        self._theirs.close()
        return self._ours


def take_up(word: str) -> socket.socket:
    """In the simulator's process: its end of the line."""
    return socket.socket(fileno=int(word))
