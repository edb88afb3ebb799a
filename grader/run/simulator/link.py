"""The simulator's end of the link to a submission's process, which it does not trust."""

from __future__ import annotations

import os
import select
import socket
import time
from collections.abc import Iterable, Iterator
from contextlib import suppress
from typing import Literal

from grader.run.limits import Patience
from grader.run.lockstep.protocol import (
    MOST_SENT,
    MOST_SENT_BYTES,
    PROGRESS,
    Advance,
    Kind,
    Mail,
    Note,
    Packet,
    PacketReader,
    Parcels,
    ProtocolError,
    Table,
    decode,
    encode,
    pieces,
)
from grader.system import linux
from grader.text.message import Message, msg

#: How often the process is checked while it is silent [ms], and while it is not [s].
POLL_MS = 250
CPU_CHECK_S = 1.0
MOST_FLAGS = 20
#: A shorter wait is not counted as sleep [s].
SHORT_S = 0.02
#: Another thread's second of processor time may have been so many in the queue, on a busy machine.
MOST_QUEUING = 20.0
#: More packets than a mailbox holds; a process that fills it meanwhile has to wait.
MOST_MAIL = 2_000
#: The longest packet that is accepted from a submission's process.
LIMIT_BYTES = 8_000_000
#: The kernel's letter for a process that has a processor, or waits for one.
WANTS_PROCESSOR = "R"
ELSEWHERE = msg("the submission waits for something outside of Python's and ROS's own waiting")
NONSENSE = msg("its process sent what ours never sends")
TOO_MANY = msg(
    "the node sent more than {number} messages, or more than {most} GB in them",
    number=MOST_SENT,
    most=MOST_SENT_BYTES // 10**9,
)


class Refused(Exception):
    """The run cannot be made in virtual time; `why` completes "because ..."."""

    def __init__(self, why: Message) -> None:
        super().__init__(why)
        self.why = why


class StudentLink:
    """Receives from a submission's process, and watches it.

    Attributes:
        silence: why nothing comes any more: '', `gone`, `stalled`, `stopped`, `slow`, `broken`,
            `flooding` - it keeps the simulator from its work.
        waits: `for ever` - it waits for something that will not come, as a program may after its
            work; `stuck` - in a callback, where it must not.
        flags: remarks for the result.
        excused_cpu_s: processor time of the simulator's that is not the submission's doing [s].
    """

    def __init__(
        self,
        link: socket.socket,
        page: int,
        pid: int,
        patience: Patience,
        others: Iterable[int] = (),
    ) -> None:
        """Watch process `pid` at the other end, which writes its tick into the page.

        Args:
            others: the other programs' processes, with which it shares its processor time.
        """
        self.silence = ""
        self.waits: Literal["", "for ever", "stuck"] = ""
        self.flags: list[Message] = []
        self.excused_cpu_s = 0.0
        link.setblocking(False)
        self._link = link
        self._packets = PacketReader(link, LIMIT_BYTES)
        self._pid = pid
        self._used_s = dict.fromkeys((pid, *others), 0.0)
        self._may_read, self._may_send = select.poll(), select.poll()
        self._may_read.register(link, select.POLLIN)
        self._may_send.register(link, select.POLLOUT)
        self._patience = patience
        self._next_check_s = time.monotonic() + CPU_CHECK_S
        self._stall_cpu_s = patience.start_cpu_s
        self._asleep_s = self._seen_cpu_s = 0.0
        self._cpu_before_s = time.process_time()
        self._page = page

    def introduce(self, table: Table) -> None:
        """Send the first table, with the end of the socket that `mail` reads."""
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        ours.setblocking(False)
        self.mailbox, self._mail = ours, PacketReader(ours, LIMIT_BYTES)
        with suppress(OSError), theirs:
            socket.send_fds(self._link, [encode(table)], [theirs.fileno()])

    def mail(self) -> Iterator[Parcels]:
        """Yield what the submission has sent since the last call, even after its death."""
        with suppress(OSError):  # there is no more, or nobody
            for _ in range(MOST_MAIL):
                if self.silence == "broken":
                    return
                try:
                    data = self._mail.read()
                    if data == b"":
                        return
                    packet = decode(data) if data else Mail([])
                except ProtocolError:
                    packet = None
                if isinstance(packet, Mail):
                    yield packet.parcels
                else:
                    self.break_off(NONSENSE)

    def reached(self) -> int:
        """Return the tick that the submission's process reports, even after its death."""
        return int(PROGRESS.unpack(os.pread(self._page, PROGRESS.size, 0))[0])

    def send(self, packet: Packet) -> None:
        """Send a packet; a process that is gone is noticed when receiving.

        One that asks and does not read the answer is waited for like one that sends nothing.
        """
        with suppress(OSError):
            for piece in pieces(encode(packet)):
                while not self.silence and not self._send(piece):
                    self._await_reader()

    def _send(self, piece: bytes) -> bool:
        try:
            self._link.send(piece)
        except BlockingIOError:
            return False
        return True

    def _await_reader(self) -> None:
        try:
            self._wait(self._may_send)
        except Refused:
            self.break_off(msg("its process does not read what it has asked for"))

    def receive(self) -> Table | Advance | None:
        """Return the next request; None when there will be no other: see `silence`.

        Raises:
            Refused: the submission does what virtual time cannot follow.
        """
        while not self.silence:
            if not self._wait(self._may_read):
                return None
            try:
                data = self._packets.read()
                if data is None:
                    continue  # there is more of it
                packet = decode(data) if data else None
            except BlockingIOError:
                continue
            except OSError:
                packet = None
            except ProtocolError:
                self.break_off(NONSENSE)
                break
            match packet:
                case None:
                    self.silence = "gone"
                case Note():
                    self._handle(packet)
                case Table() | Advance():
                    return packet
                case _:
                    self.break_off(NONSENSE)
        return None

    def flag(self, remark: Message) -> None:
        """Add a remark for the result, once."""
        if remark not in self.flags and len(self.flags) < MOST_FLAGS:
            self.flags.append(remark)

    def note_start(self) -> None:
        """Expect more of it from now on: it has asked for time, so its imports are over."""
        self._stall_cpu_s = self._patience.stall_cpu_s

    def _handle(self, note: Note) -> None:
        match note.kind:
            case Kind.STUCK:
                self.waits = "stuck"
            case Kind.WAITING:
                self.waits = self.waits or "for ever"
            case Kind.UNSUPPORTED:
                raise Refused(msg("the submission {does}", does=note.remark))
            case Kind.FAILED:
                raise Refused(note.remark)
            case Kind.FLOODING:
                self.break_off(TOO_MANY)

    def break_off(self, why: Message) -> None:
        """Receive nothing more: it does what no process of ours does. `why` becomes a flag."""
        self.silence = "broken"
        self.flags.append(why)  # it decides the run, however many there are

    def _wait(self, poll: select.poll) -> bool:
        """Wait until the link can be read, or written; False if it never will."""
        began = time.monotonic()
        if poll.poll(POLL_MS):
            if time.monotonic() - began > SHORT_S:
                self._count_sleep(linux.process_stat(self._pid), began)
            return not self._is_slow()
        used_s = last_used_s = linux.process_stat(self._pid).cpu_s
        asleep_since = before = now = time.monotonic()
        patience = self._patience
        while not poll.poll(POLL_MS):
            seen, now = linux.process_stat(self._pid), time.monotonic()
            self._count_sleep(seen, before)
            before = now
            if seen.has_ended and not poll.poll(0):  # a descendant holds the link
                self.silence = "gone"
                return False
            if seen.cpu_s - used_s > self._stall_cpu_s:
                self.silence = "stalled"
                return False
            if seen.cpu_s > last_used_s or seen.state == WANTS_PROCESSOR:
                last_used_s, asleep_since = seen.cpu_s, now
            is_too_long = now - asleep_since > patience.asleep_s
            if is_too_long or self._asleep_s > patience.all_asleep_s:
                if seen.is_stopped:
                    self.silence = "stopped"
                    return False
                raise Refused(ELSEWHERE)
        return not self._is_slow()

    def _count_sleep(self, seen: linux.ProcessStat, since_s: float) -> None:
        """Add up how long it wanted no processor, however often it woke for a moment."""
        used_s, self._seen_cpu_s = seen.cpu_s - self._seen_cpu_s, seen.cpu_s
        if seen.state != WANTS_PROCESSOR:
            waited_s = time.monotonic() - since_s
            self._asleep_s += max(0.0, waited_s - MOST_QUEUING * used_s)

    def _is_slow(self) -> bool:
        """Whether the run has used up its processor time; measured once in `CPU_CHECK_S`."""
        now = time.monotonic()
        if now > self._next_check_s:
            self._next_check_s = now + CPU_CHECK_S
            spent_s = time.process_time() - self._cpu_before_s - self.excused_cpu_s
            if self._used_cpu_s() > self._patience.run_cpu_s:
                self.silence = "slow"
            elif self._asleep_s > self._patience.all_asleep_s:
                raise Refused(ELSEWHERE)
            elif spent_s > self._patience.simulator_cpu_s:
                self.silence = "flooding"
        return bool(self.silence)

    def _used_cpu_s(self) -> float:
        """Return the processor time of all programs, those that have ended included [s]."""
        for pid, before_s in self._used_s.items():
            self._used_s[pid] = max(before_s, linux.process_stat(pid).cpu_s)
        return sum(self._used_s.values())
