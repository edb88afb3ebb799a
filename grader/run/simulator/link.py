"""The simulator's end of the link to a submission's process, which it does not trust."""

from __future__ import annotations

import os
import select
import socket
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from grader.run.lockstep.protocol import (
    LIMIT_BYTES,
    Advance,
    Hello,
    Kind,
    Note,
    Packet,
    ProtocolError,
    decode,
    encode,
)
from grader.text import without_controls

#: How often it is looked at [ms].
LOOK_MS = 250
MOST_FLAGS = 20


@dataclass(frozen=True)
class Patience:
    """How long a submission's process is waited for, in real seconds.

    Attributes:
        stall_cpu_s: it has stalled when it says nothing for so much of its own processor time,
        start_cpu_s: or for so much while it still imports.
        asleep_s: it waits for something outside of virtual time when it sleeps for so long.
        run_s: what a whole run may take.
    """

    stall_cpu_s: float = 6.0
    start_cpu_s: float = 20.0
    asleep_s: float = 6.0
    run_s: float = 120.0


class Refused(Exception):
    """The run cannot be made in virtual time; the text completes "because ..."."""


class StudentLink:
    """Hears a submission's process for as long as there is something to hear.

    Attributes:
        silence: why nothing comes any more: '', `gone`, `stalled`, `slow`, `broken`.
        has_left: the submission ended in good order, and has announced all that it sent.
        waits: `for ever` - it waits for something that will not come, as a program may that has
            done its work; `stuck` - in a callback, where it must not.
        flags: remarks for the result.
    """

    def __init__(self, link: socket.socket, pid: int, patience: Patience) -> None:
        self.silence = ""
        self.has_left = False
        self.waits: Literal["", "for ever", "stuck"] = ""
        self.flags: list[str] = []
        self._link = link
        self._pid = pid
        self._poll = select.poll()
        self._poll.register(link, select.POLLIN)
        self._patience = patience
        self._end = time.monotonic() + patience.run_s
        self._stall_cpu_s = patience.start_cpu_s

    def send(self, packet: Packet) -> None:
        """Say something; that nobody listens is noticed when receiving."""
        with suppress(OSError):
            self._link.send(encode(packet))

    def receive(self) -> Hello | Advance | None:
        """The next request; None when there will be no other: see `silence`.

        Raises:
            Refused: the submission does what virtual time cannot follow.
        """
        while not self.silence:
            if not self._wait():
                return None
            try:
                data = self._link.recv(LIMIT_BYTES)
                packet = decode(data) if data else None
            except OSError:
                packet = None
            except ProtocolError:
                self._break("its process sent what ours never sends")
                break
            match packet:
                case None:
                    self.silence = "gone"
                case Note():
                    self._hear(packet)
                case Hello() | Advance():
                    return packet
                case _:
                    self._break("its process sent what only a simulator says")
        return None

    def flag(self, text: str) -> None:
        """Remark something, once."""
        if text not in self.flags and len(self.flags) < MOST_FLAGS:
            self.flags.append(text)

    def has_started(self) -> None:
        """It has asked for time, so it does not import any more."""
        self._stall_cpu_s = self._patience.stall_cpu_s

    def _hear(self, note: Note) -> None:
        text = without_controls(note.text[:200], "?")
        match note.kind:
            case Kind.LEAVING:
                self.has_left = True
            case Kind.STUCK:
                self.waits = "stuck"
            case Kind.WAITING:
                self.waits = self.waits or "for ever"
            case Kind.UNSUPPORTED:
                raise Refused(f"the submission {text}")
            case Kind.FAILED:
                raise Refused(text)
            case Kind.WARNING:
                self.flag(text)

    def _break(self, why: str) -> None:
        self.silence = "broken"
        self.flag(why)

    def _wait(self) -> bool:
        """Wait for a packet; False if none will come."""
        if self._poll.poll(LOOK_MS):
            if time.monotonic() < self._end:
                return True
            self.silence = "slow"
            return False
        used, last_used = _cpu_s(self._pid), _cpu_s(self._pid)
        asleep_since = time.monotonic()
        while not self._poll.poll(LOOK_MS):
            now_used, now = _cpu_s(self._pid), time.monotonic()
            if now_used - used > self._stall_cpu_s:
                self.silence = "stalled"
                return False
            if now_used > last_used or not _sleeps(self._pid):
                last_used, asleep_since = now_used, now
            if now - asleep_since > self._patience.asleep_s:
                raise Refused(
                    "the submission waits for something outside of Python's and ROS's own waiting"
                )
            if now > self._end:
                self.silence = "slow"
                return False
        return True


def _stat(pid: int) -> list[str]:
    try:
        text = Path(f"/proc/{pid}/stat").read_text(encoding="ascii", errors="replace")
    except OSError:
        return []
    return text.rsplit(")", 1)[1].split()


def _cpu_s(pid: int) -> float:
    """The processor time that a process has used; 0 if there is none."""
    fields = _stat(pid)
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK") if fields else 0.0


def _sleeps(pid: int) -> bool:
    """Whether a process waits, without wanting the processor."""
    return _stat(pid)[:1] == ["S"]
