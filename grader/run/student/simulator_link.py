"""The student's end of the link to the simulator: messages, and time.

Whatever the program sends goes out at once, and counts from the next request for time; whatever
the simulator sends comes with its reply to that. Of the ticks to come the simulator says in advance
what they will bring, if nothing is sent meanwhile; these pass without a word to it.
"""

from __future__ import annotations

import socket
from collections import deque
from collections.abc import Callable
from typing import Any

from grader.run.lockstep import real
from grader.run.lockstep.protocol import (
    FOREVER,
    MOST_SENT,
    MOST_SENT_BYTES,
    TICK_NS,
    Advance,
    Interests,
    Kind,
    Parcel,
    Reply,
    State,
    Table,
)
from grader.run.lockstep.registry import Arrived, EndpointRegistry, Reader, Writer
from grader.run.lockstep.times import EPOCH_NS, NEVER
from grader.run.student.channel import SimulatorChannel
from grader.run.student.remotes import Remotes
from grader.run.student.scheduler import Scheduler

UNBOUNDED = 0xFFFFFFFF
#: What sending a message costs: 20 us. What counting the endpoints of a channel costs.
SEND_UNITS = 4
QUESTION_UNITS = 4
#: How long we may go on without a word to the simulator, in real time [s]: it would think that the
#: program hangs.
LONGEST_ALONE_S = 0.25
#: How long DDS may take to find what is there, where the program asks for it, in real time [s]. A
#: run in which it takes longer is made again, in real time.
DDS_PATIENCE_S = 60.0


class SimulatorLink(EndpointRegistry):
    """The student's side of the link, and all endpoints of its process."""

    def __init__(self, scheduler: Scheduler, refuse: Callable[[str], None]) -> None:
        super().__init__(lambda: EPOCH_NS + scheduler.now_ns)
        self.refuse = refuse
        self.tick = 0
        #: counts how often the endpoints were connected anew
        self.graph_epoch = 0
        #: whether a thread waits for what comes on these readers
        self.is_listening: Callable[[], bool] = lambda: False
        #: called after something may have arrived
        self.on_arrival: Callable[[], None] = lambda: None
        #: called when nothing can ever happen any more
        self.on_standstill: Callable[[], None] = lambda: None
        #: called when the run is over, before this process ends for it
        self.on_over: Callable[[], None] = lambda: None
        self.remotes = Remotes()
        self._scheduler = scheduler
        self._channel = SimulatorChannel(refuse)
        self._is_connected = False
        self._sent = self._sent_bytes = 0
        #: since the simulator was told last
        self._has_mailed = False
        #: the readers for responses, by the numbers that requests carry
        self._clients: dict[int, Reader] = {}
        self._client_numbers: dict[Reader, int] = {}
        self._interests = Interests(())
        #: messages not delivered yet, by tick: those of ticks that the simulator has foreseen
        self._incoming: deque[Parcel] = deque()
        self._foreseen_to = 0
        #: the simulator does not know that we have got as far as we have
        self._is_ahead = False
        self._spoken_s = 0.0
        self._waited_for = (0, "")
        self._waits_until_s = 0.0

    def take_up(self, connection: socket.socket) -> None:
        """Take up the link, before anything else."""
        self._channel.take_up(connection)

    # Time -------------------------------------------------------------------------------------

    def advance(self, deadline_ns: int) -> None:
        """Let time move to what happens next: our deadline, or something from the simulator."""
        scheduler = self._scheduler
        if deadline_ns < (self.tick + 1) * TICK_NS:
            scheduler.set_now(max(deadline_ns, scheduler.now_ns))
            return
        self.connect()
        if deadline_ns == NEVER:
            self.on_standstill()
        target = min(deadline_ns // TICK_NS, FOREVER)
        most = 1 if self.is_listening() else UNBOUNDED
        if self._has_mailed or not self._live_through_foreseen(target, most):
            self._exchange(target, most)
        scheduler.set_now(max(scheduler.now_ns, self.tick * TICK_NS))
        self.on_arrival()

    def _live_through_foreseen(self, target: int, most: int) -> bool:
        """Let ticks pass that the simulator has told in advance; whether any has."""
        last = min(target, self.tick + most, self._foreseen_to)
        if self.tick >= last or real.monotonic() > self._spoken_s + LONGEST_ALONE_S:
            return False
        self._is_ahead = True
        self._live_to(last)
        return True

    def _live_to(self, tick: int) -> None:
        """Let time pass to a tick, with the messages up to it."""
        self.tick = tick
        self._channel.has_reached(tick)
        incoming = self._incoming
        while incoming and incoming[0].tick <= tick:
            self._deliver(incoming.popleft())

    def synchronise(self) -> None:
        """Have the simulator take everything that we have sent, in no time."""
        self.connect()
        if self._has_mailed or self._is_ahead:
            self._exchange(self.tick, 0)

    def _exchange(self, target: int, most: int) -> None:
        self._incoming.clear()
        self._is_ahead = False
        has_mailed, self._has_mailed = self._has_mailed, False
        self._channel.send(Advance(target, most, self.tick, has_mailed))
        table = None
        while not isinstance(packet := self._channel.receive(), Reply):
            if not isinstance(packet, Table):
                self._channel.fail(packet, "a reply")
            table = packet
            self.remotes.add(table)
            self._connect_anew()
        self._spoken_s = real.monotonic()
        self._incoming.extend(packet.parcels)
        self._foreseen_to = packet.foreseen
        self._live_to(packet.tick)
        if table is not None:
            self.remotes.remove(table)
            self._connect_anew()
        if packet.state == State.OVER:
            self.on_over()
            real.leave(0)

    # Messages ---------------------------------------------------------------------------------

    def before_question(self) -> None:
        """Who asks for counterparts is to see all that the simulator has."""
        self.connect()
        self._scheduler.charge(QUESTION_UNITS)

    def publish(self, writer: Writer, data: bytes) -> None:
        """To readers in this process at once, to the simulator with the next request for time."""
        super().publish(writer, data)
        for remote in writer.remote:
            self._mail(Parcel(remote.id, 0, writer.sent, self.tick, data))
        self._has_sent(data, writer.local)

    def ask(self, writer: Writer, client: Reader, data: bytes) -> int:
        """The same with a request."""
        number = super().ask(writer, client, data)
        for remote in writer.remote:
            client.awaited += 1
            self._mail(Parcel(remote.id, self._number(client), number, self.tick, data))
        self._has_sent(data, writer.local)
        return number

    def respond(self, writer: Writer, to: Arrived, data: bytes) -> None:
        """The same with a response; the simulator never asks."""
        super().respond(writer, to, data)
        self._has_sent(data, [to.client])

    def _has_sent(self, data: bytes, local: list[Any]) -> None:
        self._sent += 1
        self._sent_bytes += len(data)
        if self._sent > MOST_SENT or self._sent_bytes > MOST_SENT_BYTES:
            self.note(Kind.FLOODING)
            self.on_over()
            real.leave(0)
        if local:
            self.on_arrival()
        self._scheduler.charge(SEND_UNITS)

    def _number(self, client: Reader) -> int:
        number = self._client_numbers.setdefault(client, len(self._client_numbers) + 1)
        self._clients[number] = client
        return number

    def _mail(self, parcel: Parcel) -> None:
        self._has_mailed = True
        rest = self._channel.mail(parcel)
        while rest:
            self._exchange(self.tick, 0)
            self._has_mailed = True
            rest = self._channel.mail_rest(rest)

    def _deliver(self, parcel: Parcel) -> None:
        endpoint, client, number, tick, data = parcel
        arrived = Arrived(data, EPOCH_NS + tick * TICK_NS, number)
        if client:
            reader = self._clients[client]
            reader.awaited -= 1
            reader.items.append(arrived)
            return
        remote = self.remotes.by_number[endpoint]
        if remote.is_lasting:
            remote.history.append(arrived)
        for reader in remote.readers:
            reader.items.append(arrived)

    # Connections ------------------------------------------------------------------------------

    def connect(self) -> None:
        """Connect what belongs together, and tell the simulator what we read and publish."""
        if not self._is_connected:
            self._is_connected = True
            self.remotes.add(self._channel.introduction())
            self._connect_anew()
        if not self.changed:
            return
        self.changed = False
        self._connect_anew()
        topics = {(w.name, w.type) for w in self.writers if w.kind == "topic"}
        reads = {reader.channel for reader in self.readers if reader.kind != "request"}
        interests = Interests(tuple(sorted(reads)), tuple(sorted(topics)))
        if interests != self._interests:
            self._interests = interests
            if self._is_ahead:  # foreseen for the readers that there were
                self._exchange(self.tick, 0)
            self._incoming.clear()
            self._foreseen_to = self.tick
            self._channel.send(interests)

    def _connect_anew(self) -> None:
        self._is_unpaired = True
        self.pair_locally()
        self.remotes.pair(self.writers, self.readers)
        self.graph_epoch += 1

    def await_dds(self, what: str) -> None:
        """Really wait a little until DDS has found what we know to be there.

        Where that is in vain, the run cannot be made here: DDS has lost something.
        """
        if self._waited_for != (self.graph_epoch, what):
            self._waited_for = (self.graph_epoch, what)
            self._waits_until_s = real.monotonic() + DDS_PATIENCE_S
        if real.monotonic() > self._waits_until_s:
            self.note(Kind.FAILED, f"DDS did not tell of an {what} in {DDS_PATIENCE_S:.0f} s")
            real.leave(0)
        real.sleep(0.0005)

    def note(self, kind: Kind, text: str = "") -> None:
        """Tell the simulator something about this process."""
        self._channel.note(kind, text)
