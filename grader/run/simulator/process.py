"""What a simulator's process does in real time as in virtual time: precautions, and what it says.

To the grader it says how far it is. To the audience of a run it tells what is to be seen, and keeps
the run slow enough to see: through a socket from which nothing is read, so that what a run comes to
does not depend on who looks on. What is not taken at once is kept, up to a limit; then the run
waits a little, and then it goes on unseen. Both is JSON, a line for each piece of news.
"""

from __future__ import annotations

import json
import resource
import select
import signal
import socket
import time
from collections.abc import Mapping
from typing import Any, Final, Self

from grader import linux
from grader.run.limits import SIMULATOR_BYTES

#: So much may wait to be taken [bytes]; then so long is waited for it, in a whole run [s].
MOST_BYTES: Final = 8_000_000
PATIENCE_S: Final = 10.0
#: Who is so late does not hurry to make up for it [s].
LATE_S: Final = 0.1
#: The last line of a run that was told to its end.
END: Final = {"over": True}


def take_precautions() -> None:
    """Before anything else: what it serves must not reach it, nor fill the machine."""
    linux.control(linux.PR_SET_DUMPABLE, 0)  # nobody else looks into our memory and descriptors
    linux.lower_limit(resource.RLIMIT_DATA, SIMULATOR_BYTES, resource.RLIM_INFINITY)
    # Ctrl-C in a terminal reaches the whole group; the grader decides what happens then.
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def say(control: socket.socket, what: str, **more: Any) -> None:
    """Say something to the grader, which may take its time to hear it; it says so, too."""
    control.sendall(_line({"say": what, **more}))


def _line(news: Mapping[str, Any]) -> bytes:
    return json.dumps(news, separators=(",", ":")).encode() + b"\n"


class Telling:
    """The simulator's end of what the audience of a run hears.

    Attributes:
        cpu_s: processor time that it has taken [s].
    """

    def __init__(self, descriptor: int, speed: float | None, tick_ns: int) -> None:
        """Tell what happens.

        Args:
            speed: how many times as fast as in real time; None: as fast as it goes.
        """
        self.cpu_s = 0.0
        self._socket = socket.socket(fileno=descriptor)
        self._socket.setblocking(False)
        self._waiting = bytearray()
        self._patience_s = PATIENCE_S
        self._is_heard = True
        self._tick_s = tick_ns / 1e9 / speed if speed else 0.0
        self._due_s = 0.0

    @classmethod
    def of(cls, words: str, tick_ns: int) -> Self | None:
        """As `grader.run.simulator_process` asks for it; None where nobody looks on."""
        return cls(**json.loads(words), tick_ns=tick_ns) if words else None

    def tell(self, news: Mapping[str, Any]) -> None:
        """Tell something; never waits for long."""
        if not self._is_heard:
            return
        began_s = time.process_time()
        self._waiting += _line(news)
        self._send()
        if len(self._waiting) > MOST_BYTES:
            self._wait_for_room()
        self.cpu_s += time.process_time() - began_s

    def pace(self) -> None:
        """Wait until the next tick is due."""
        if not self._tick_s:
            return
        now_s = time.monotonic()
        if now_s < self._due_s:
            time.sleep(self._due_s - now_s)
        elif now_s > self._due_s + LATE_S:
            self._due_s = now_s
        self._due_s += self._tick_s

    def close(self) -> None:
        """Say that all is told, and see that it is taken."""
        self.tell(END)
        self._wait_for_room(0)
        self._socket.close()

    def _send(self) -> None:
        try:
            while self._waiting:
                del self._waiting[: self._socket.send(self._waiting)]
        except BlockingIOError:
            return
        except OSError:  # nobody is there any more
            self._give_up()

    def _wait_for_room(self, most_bytes: int = MOST_BYTES) -> None:
        while self._is_heard and len(self._waiting) > most_bytes:
            began_s = time.monotonic()
            select.select((), (self._socket,), (), max(0.0, self._patience_s))
            self._patience_s -= time.monotonic() - began_s
            self._send()
            if self._patience_s <= 0.0 and len(self._waiting) > most_bytes:
                self._give_up()

    def _give_up(self) -> None:
        self._is_heard = False
        self._waiting.clear()
