"""The student's end of the link to the simulator: messages, and time.

Whatever the program sends goes out at once, and counts from the next request for time; whatever
the simulator sends comes with its reply to that. The reply also forecasts the next ticks, for the
case that nothing is sent meanwhile; these pass without a request.
"""

from __future__ import annotations

import mmap
import os
import socket
from collections import deque
from collections.abc import Callable
from typing import NoReturn

from grader.run.clock.scheduler import Scheduler
from grader.run.lockstep import real
from grader.run.lockstep.faults import guarded
from grader.run.lockstep.matching import Arrived, EndpointRegistry, Reader, Writer
from grader.run.lockstep.protocol import (
    EPOCH_NS,
    MOST_SENT,
    MOST_SENT_BYTES,
    NEVER,
    PIECE_BYTES,
    PROGRESS,
    PROGRESS_BYTES,
    SHIFT,
    TICK_NS,
    Advance,
    Kind,
    Mail,
    Note,
    Packet,
    PacketReader,
    Parcel,
    ProtocolError,
    Reply,
    Table,
    decode,
    encode,
    pieces,
)
from grader.text.message import NOTHING, Message, msg

#: The costs of sending a message, 20 us, and of counting the endpoints of a channel.
SEND_UNITS = 4
QUESTION_UNITS = 4
#: How long we may go on without a request, in real time [s]: the simulator would think that the
#: program hangs.
LONGEST_ALONE_S = 0.25


class SimulatorSockets:
    """The two sockets to the simulator, and the page that both processes have.

    When the simulator is gone, this process ends: nothing that it does could be recorded.
    """

    def __init__(
        self, connection: socket.socket, page: int, refuse: Callable[[Message], None]
    ) -> None:
        self._refuse = refuse
        self._connection = connection
        self._packets = PacketReader(connection)
        self._mailbox: socket.socket
        self._progress = mmap.mmap(page, PROGRESS_BYTES)

    def introduction(self) -> Table:
        """Wait for the first table, and with it the mailbox."""
        try:
            data, descriptors, _, _ = socket.recv_fds(self._connection, PIECE_BYTES, 1)
        except OSError:
            data = b""
        table = self._decode(data)
        if not isinstance(table, Table) or len(descriptors) != 1:
            self._break(ProtocolError(f"{table!r:.200} where a table was expected"))
        (mailbox,) = descriptors
        os.set_inheritable(mailbox, False)
        self._mailbox = socket.socket(fileno=mailbox)
        self._mailbox.setblocking(False)
        return table

    def send(self, packet: Packet) -> None:
        try:
            for piece in pieces(encode(packet)):
                self._connection.send(piece)
        except OSError:
            real.leave(1)

    def receive(self) -> Table | Reply:
        data: bytes | None = None
        while data is None:
            try:
                data = self._packets.read()
            except OSError:
                data = b""
        return self._decode(data)

    def mail(self, pieces: list[bytes]) -> list[bytes]:
        """Put the pieces of a parcel into the mailbox; return those for which it is too full."""
        for number, piece in enumerate(pieces):
            try:
                self._mailbox.send(piece)
            except BlockingIOError:
                return pieces[number:]
            except OSError:
                real.leave(1)
        return []

    def write_tick(self, tick: int) -> None:
        """Write the tick where it is read after this process, even if that ends silently."""
        PROGRESS.pack_into(self._progress, 0, tick)

    def _decode(self, data: bytes) -> Table | Reply:
        """Decode a packet, which is one of these."""
        if not data:
            real.leave(1)
        try:
            packet = decode(data)
        except ProtocolError as error:
            self._break(error)
        if not isinstance(packet, Table | Reply):
            self._break(ProtocolError(f"{packet!r:.200} was not expected"))
        return packet

    def _break(self, error: ProtocolError) -> NoReturn:
        """Refuse a wrong packet: the submission has read or written on the socket."""
        self._refuse(msg("broke our virtual time ({error})", error=f"{error!r:.200}"))
        raise error


class SimulatorLink(EndpointRegistry):
    """The student's side of the link, and all endpoints of its process.

    Attributes:
        tick: the last that has begun for the program.
        is_listening: whether a thread waits for what others publish.
        on_arrival: called after something may have arrived.
        on_standstill: called when no thread of the program has a deadline.
        on_over: called when the run is over, before this process ends for it.
        is_recorded: whether the simulator has hidden readers for what the program publishes.
    """

    def __init__(
        self,
        scheduler: Scheduler,
        connection: socket.socket,
        page: int,
        refuse: Callable[[Message], None],
        number: int = 0,
    ) -> None:
        """Link a program with its simulator.

        Args:
            connection: to the simulator, which sends its first table when it is ready.
            page: a descriptor of the page that both have.
            refuse: called with what the program does that virtual time cannot follow.
            number: of a program among several, from 1; 0 for one alone.
        """
        super().__init__(lambda: EPOCH_NS + scheduler.now_ns, number or 1)
        self.refuse = refuse
        self.tick = 0
        self.is_listening: Callable[[], bool] = lambda: False
        self.on_arrival: Callable[[], None] = lambda: None
        self.on_standstill: Callable[[], None] = lambda: None
        self.on_over: Callable[[], None] = lambda: None
        self.is_recorded = False
        self._scheduler = scheduler
        self._sockets = SimulatorSockets(connection, page, refuse)
        #: the last reply, when it came in real time [s], and the last tick of its forecast
        self._reply = Reply(0, False, 0, 0 if number else NEVER)
        self._replied_s, self._foreseen = 0.0, 0
        #: the messages of the forecast that have not been delivered, by tick
        self._parcels: deque[Parcel] = deque()
        #: something was mailed since, which the forecast does not consider; it is for other
        #: programs, which must get it now
        self._has_mail = self._has_mail_for_others = False
        self._now_ns = 0
        self._is_introduced = False
        self._sent = self._sent_bytes = 0
        self._for_late: list[Parcel] = []

    # Time -------------------------------------------------------------------------------------

    @guarded
    def advance(self, deadline_ns: int) -> None:
        """Move time to the next event: our deadline, or something from the simulator."""
        scheduler = self._scheduler
        free_ns = min((self.tick + 1) * TICK_NS, self._reply.until_ns)
        if deadline_ns < free_ns and not self._has_mail_for_others:
            scheduler.set_now(max(deadline_ns, scheduler.now_ns))
            return
        self.connect()
        if deadline_ns == NEVER:
            self.on_standstill()
        listens = self.is_listening()
        if self._has_mail or not self._use_forecast(deadline_ns, listens=listens):
            self._exchange(deadline_ns, listens=listens)
        scheduler.set_now(max(scheduler.now_ns, self._now_ns))
        self.on_arrival()

    def _use_forecast(self, deadline_ns: int, *, listens: bool) -> bool:
        """Let forecast ticks pass; return whether any has."""
        last = min(deadline_ns // TICK_NS, self._foreseen)
        if listens:
            last = min(last, self.tick + 1)
        if self.tick >= last or real.monotonic() > self._replied_s + LONGEST_ALONE_S:
            return False
        self._move_to(last * TICK_NS)
        return True

    def _move_to(self, now_ns: int) -> None:
        """Move on to a time, and deliver the messages up to then."""
        self._now_ns = now_ns
        if now_ns // TICK_NS > self.tick:
            self.tick = now_ns // TICK_NS
            self._sockets.write_tick(self.tick)
        while self._parcels and self._parcels[0].time_ns <= now_ns:
            self._deliver(self._parcels.popleft())

    def synchronise(self) -> None:
        """Have the simulator catch up with our tick and our mail; no time passes."""
        self.connect()
        if self._has_mail or self._is_ahead():
            self._exchange()

    def _is_ahead(self) -> bool:
        """Whether ticks of the forecast have passed since the last reply."""
        return self.tick > self._reply.now_ns // TICK_NS

    def _exchange(self, deadline_ns: int = 0, *, listens: bool = False) -> None:
        """Ask for time, to a deadline or, without one, for none, and handle the reply."""
        now_ns = self._scheduler.now_ns
        self._sockets.send(Advance(deadline_ns, listens, self.tick, now_ns, self._has_mail))
        removed: list[int] = []
        while isinstance(packet := self._sockets.receive(), Table):
            removed += packet.removed
            self.add_others(packet)
            self._connect_anew()
        self._reply, self._replied_s = packet, real.monotonic()
        self._parcels, self._foreseen = deque(packet.parcels), packet.foreseen
        self._has_mail = self._has_mail_for_others = False
        self._move_to(packet.now_ns)
        if removed:
            self.remove_others(removed)
            self._connect_anew()
        if packet.is_over:
            self.on_over()
            real.leave(0)
        parcels, self._for_late = self._for_late, []
        for parcel in parcels:  # what writers keep for readers that come late
            self.send_parcel(parcel)

    # Messages ---------------------------------------------------------------------------------

    def before_question(self) -> None:
        """Connect, and charge for it: a query for counterparts is to find all of them."""
        self.connect()
        self._scheduler.charge(QUESTION_UNITS)

    def note_sent(self, data: bytes, *, is_local: bool) -> None:
        """Count a message, and charge for it; the run ends where there are too many."""
        self._sent += 1
        self._sent_bytes += len(data)
        if self._sent > MOST_SENT or self._sent_bytes > MOST_SENT_BYTES:
            self.note(Kind.FLOODING)
            self.on_over()
            real.leave(0)
        if is_local:
            self.on_arrival()
        self._scheduler.charge(SEND_UNITS)

    def send_parcel(self, parcel: Parcel) -> None:
        """Put a message into the simulator's mailbox; where that is full, have it emptied."""
        rest = list(pieces(encode(Mail([parcel]))))
        while True:
            self._has_mail = True
            self._has_mail_for_others |= parcel.endpoint >> SHIFT != 0
            if not (rest := self._sockets.mail(rest)):
                return
            self._exchange()

    def _deliver(self, parcel: Parcel) -> None:
        endpoint, client, number, time_ns, data = parcel
        arrived = Arrived(data, EPOCH_NS + time_ns, number, client or None)
        reader = self.own.get(endpoint)
        if isinstance(reader, Reader):
            reader.awaited -= reader.kind == "response"
            reader.items.append(arrived)
        elif isinstance(writer := self.others.get(endpoint), Writer):
            self.deliver(writer, arrived)

    # Connections ------------------------------------------------------------------------------

    def connect(self) -> None:
        """Connect our endpoints with those of others, which get our table."""
        if not self._is_introduced:
            self._is_introduced = True
            table = self._sockets.introduction()
            if table.now_ns:  # later than the run; nothing has happened here before
                self._move_to(table.now_ns)
                self._scheduler.set_now(table.now_ns)
            self.add_others(table)
            self._connect_anew()
        if not self.changed:
            return
        table = self.pop_table()
        self._connect_anew()
        if table.added or table.removed:
            if self._is_ahead():  # forecast for the readers that there were
                self._exchange()
            self._parcels.clear()
            self._foreseen = self.tick
            self._sockets.send(table)
            if self.is_recorded:  # hidden readers of what is new, before anything is published
                self._exchange()

    def _connect_anew(self) -> None:
        before = {writer: set(writer.remote) for writer in self.writers if writer.is_lasting}
        self.pair()
        for writer, known in before.items():
            for remote in writer.remote:
                if remote not in known and remote.is_lasting:
                    self._for_late += [
                        Parcel(remote.number, 0, kept.number, kept.time_ns - EPOCH_NS, kept.data)
                        for kept in writer.history
                    ]
        self.count_meetings()

    def note(self, kind: Kind, remark: Message = NOTHING) -> None:
        """Send the simulator a note about this process."""
        self._sockets.send(Note(kind, remark))
