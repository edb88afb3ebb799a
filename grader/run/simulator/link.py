"""The simulator's end of the link to a submission's process, which it does not trust."""

from __future__ import annotations

import mmap
import os
import select
import socket
import time
from contextlib import suppress
from dataclasses import dataclass
from typing import Literal

from grader.run.lockstep.link import PacketReader, pieces
from grader.run.lockstep.protocol import (
    PROGRESS,
    Advance,
    Interests,
    Kind,
    Mail,
    Note,
    Packet,
    Parcels,
    ProtocolError,
    Table,
    decode,
    encode,
)
from grader.run.processes import usage
from grader.text import without_controls

#: How often it is looked at while it is silent [ms], and while it is not [s].
LOOK_MS = 250
CPU_LOOK_S = 1.0
MOST_FLAGS = 20
#: More packets than a mailbox holds; who fills it while it is emptied has to wait.
MOST_MAIL = 2_000


@dataclass(frozen=True)
class Patience:
    """How long a submission's process is waited for, in real seconds.

    Processor time is that of the process alone: other load on the machine decides nothing.

    Attributes:
        stall_cpu_s: it has stalled when it says nothing for so much of its own processor time,
        start_cpu_s: or for so much while it still imports.
        asleep_s: it waits for something outside of virtual time when it sleeps for so long.
        run_cpu_s: so much of its own processor time a whole run may take.
    """

    stall_cpu_s: float = 6.0
    start_cpu_s: float = 20.0
    asleep_s: float = 6.0
    run_cpu_s: float = 120.0


class Refused(Exception):
    """The run cannot be made in virtual time; the text completes "because ..."."""


class StudentLink:
    """Hears a submission's process for as long as there is something to hear.

    Attributes:
        silence: why nothing comes any more: '', `gone`, `stalled`, `stopped`, `slow`, `broken`.
        waits: `for ever` - it waits for something that will not come, as a program may that has
            done its work; `stuck` - in a callback, where it must not.
        flags: remarks for the result.
    """

    def __init__(self, link: socket.socket, pid: int, patience: Patience) -> None:
        self.silence = ""
        self.waits: Literal["", "for ever", "stuck"] = ""
        self.flags: list[str] = []
        self._link = link
        self._packets = PacketReader(link)
        self._pid = pid
        self._poll = select.poll()
        self._poll.register(link, select.POLLIN)
        self._patience = patience
        self._look_at_s = time.monotonic() + CPU_LOOK_S
        self._stall_cpu_s = patience.start_cpu_s
        self._progress = os.memfd_create("progress")
        os.ftruncate(self._progress, mmap.PAGESIZE)

    def introduce(self, table: Table) -> None:
        """Say the first word, and hand out what `mail` and `reached` read."""
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        ours.setblocking(False)
        self._mailbox, self._mail = ours, PacketReader(ours)
        with suppress(OSError), theirs:
            socket.send_fds(self._link, [encode(table)], [self._progress, theirs.fileno()])

    def close(self) -> None:
        """Give back what `introduce` has opened; the link is its owner's."""
        os.close(self._progress)
        self._mailbox.close()

    def mail(self) -> Parcels:
        """What the submission has sent since the last call; also when it is dead."""
        found: Parcels = []
        with suppress(OSError):  # there is no more, or nobody
            for _ in range(MOST_MAIL):
                data = self._mail.read()
                if data == b"":
                    break
                found += self._read_mail(data) if data else []
        return found

    def _read_mail(self, data: bytes) -> Parcels:
        try:
            packet = decode(data)
        except ProtocolError:
            packet = None
        if not isinstance(packet, Mail):
            self._break("its process sent what ours never sends")
            return []
        return packet.parcels

    def reached(self) -> int:
        """The tick that the submission's process says that it has reached; also when it is dead."""
        data = os.pread(self._progress, PROGRESS.size, 0)  # it may have cut the page off
        return int(PROGRESS.unpack(data)[0]) if len(data) == PROGRESS.size else 0

    def send(self, packet: Packet) -> None:
        """Say something; that nobody listens is noticed when receiving."""
        with suppress(OSError):
            for piece in pieces(encode(packet)):
                self._link.send(piece)

    def receive(self) -> Interests | Advance | None:
        """The next request; None when there will be no other: see `silence`.

        Raises:
            Refused: the submission does what virtual time cannot follow.
        """
        while not self.silence:
            if not self._wait():
                return None
            try:
                data = self._packets.read()
                if data is None:
                    continue  # there is more of it
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
                case Interests() | Advance():
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
            case Kind.STUCK:
                self.waits = "stuck"
            case Kind.WAITING:
                self.waits = self.waits or "for ever"
            case Kind.UNSUPPORTED:
                raise Refused(f"the submission {text}")
            case Kind.FAILED:
                raise Refused(text)

    def _break(self, why: str) -> None:
        self.silence = "broken"
        self.flag(why)

    def _wait(self) -> bool:
        """Wait for a packet; False if none will come."""
        if self._poll.poll(LOOK_MS):
            return not self._is_slow()
        used_s = last_used_s = usage.look(self._pid).cpu_s
        asleep_since = time.monotonic()
        while not self._poll.poll(LOOK_MS):
            seen, now = usage.look(self._pid), time.monotonic()
            if seen.cpu_s - used_s > self._stall_cpu_s:
                self.silence = "stalled"
                return False
            if seen.cpu_s > last_used_s or not (seen.is_stopped or seen.sleeps):
                last_used_s, asleep_since = seen.cpu_s, now
            if now - asleep_since > self._patience.asleep_s:
                if seen.is_stopped:
                    self.silence = "stopped"
                    return False
                raise Refused(
                    "the submission waits for something outside of Python's and ROS's own waiting"
                )
        return True

    def _is_slow(self) -> bool:
        """Whether the run has used up its processor time; looked at now and then."""
        now = time.monotonic()
        if now > self._look_at_s:
            self._look_at_s = now + CPU_LOOK_S
            if usage.look(self._pid).cpu_s > self._patience.run_cpu_s:
                self.silence = "slow"
        return self.silence == "slow"
