"""Somebody who looks on while a run goes on: what the simulator's process tells reaches him here.

Nothing goes the other way, so that what is recorded does not depend on it. The submission's process
has neither end.
"""

from __future__ import annotations

import json
import socket
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Final, Protocol

from grader.recording.recording import Clock
from grader.run.plan import Plan

#: News of so long travels together [s]: 31 times a second.
TOGETHER_S: Final = 0.032
#: What is taken at once, and the longest line [bytes].
CHUNK_BYTES, LONGEST_BYTES = 1 << 20, 64_000_000


class Audience(Protocol):
    """Who looks on at runs, one after the other."""

    @property
    def speed(self) -> float | None:
        """How many times as fast as in real time virtual time goes; None: as fast as it can."""

    def begins(self, plan: Plan, time: Clock) -> None:
        """A run begins by this clock; another one of the same plan, where the first was in vain."""

    def hear(self, news: Sequence[Mapping[str, Any]]) -> None:
        """What is to be seen of the run, in order; called in a thread of its own."""

    def ends(self, is_whole: bool) -> None:
        """Nothing more comes of this run; `is_whole`: and nothing was left out."""


@dataclass
class Seat:
    """What the simulator's process is told, and inherits, so that it tells of the run.

    Attributes:
        word: an argument of it; '' where nobody looks on.
    """

    word: str = ""
    _theirs: list[socket.socket] = field(default_factory=list)

    @property
    def fds(self) -> tuple[int, ...]:
        """The descriptors that it inherits."""
        return tuple(each.fileno() for each in self._theirs)

    def taken(self) -> None:
        """It has been started: from now on its end is its own."""
        for each in self._theirs:
            each.close()


NOBODY: Final = Seat()


@contextmanager
def seats(audience: Audience | None, plan: Plan, time: Clock) -> Iterator[Seat]:
    """A seat for a run; all that was told of the run has been heard when the context is left."""
    if audience is None:
        yield NOBODY
        return
    ours, theirs = socket.socketpair()
    ours.shutdown(socket.SHUT_WR)
    word = json.dumps({"descriptor": theirs.fileno(), "speed": audience.speed})
    audience.begins(plan, time)
    listener = threading.Thread(target=_listen, args=(ours, audience), name="audience", daemon=True)
    listener.start()
    seat = Seat(word, [theirs])
    try:
        yield seat
    finally:
        seat.taken()
        listener.join()


def _listen(ours: socket.socket, audience: Audience) -> None:
    """Hand on what comes until nobody has the other end."""
    pause = threading.Event()
    text, is_whole = b"", False
    try:
        with ours:  # who tells does not wait for one who has left
            while len(text) < LONGEST_BYTES and (chunk := _more(ours)):
                *lines, text = (text + chunk).split(b"\n")
                news = [json.loads(line) for line in lines]
                audience.hear([each for each in news if "over" not in each])
                is_whole = bool(news) and "over" in news[-1]
                if len(chunk) < CHUNK_BYTES and not is_whole:
                    pause.wait(TOGETHER_S)
    finally:
        audience.ends(is_whole)


def _more(ours: socket.socket) -> bytes:
    try:
        return ours.recv(CHUNK_BYTES)
    except ConnectionError:
        return b""
