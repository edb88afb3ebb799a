"""The student's end of the link to the simulator, and DDS between the two.

Before time moves, the simulator hears how much has been sent to it; afterwards we really wait
until everything that it has sent is here. Where readers or writers are new, both sides first wait
until DDS has connected them, in no virtual time.
"""

from __future__ import annotations

import socket
from collections import defaultdict
from collections.abc import Callable
from typing import Any

from grader.run.lockstep import real
from grader.run.lockstep.protocol import (
    FOREVER,
    LIMIT_BYTES,
    TICK_NS,
    Advance,
    Hello,
    Kind,
    Note,
    Packet,
    ProtocolError,
    Reply,
    State,
    Table,
    decode,
    encode,
)
from grader.run.lockstep.registry import (
    IN_FLIGHT,
    Endpoint,
    EndpointRegistry,
    Reader,
    Writer,
    compatible,
    distinct_arrivals,
    policies,
)
from grader.run.lockstep.times import NEVER
from grader.run.processes import cores
from grader.run.student.remotes import RemoteEndpoint, remembers
from grader.run.student.scheduler import Scheduler

#: How long DDS may take to connect two endpoints, or to deliver a message [s].
MATCH_PATIENCE_S = 3.0
ARRIVAL_PATIENCE_S = 2.0
#: How many ticks may pass at once where poses come but nobody waits for them.
BATCH_TICKS = 16
UNBOUNDED = 0xFFFFFFFF
#: What sending a message costs: 20 us. What counting the endpoints of a channel costs.
SEND_UNITS = 4
QUESTION_UNITS = 4


class SimulatorLink(EndpointRegistry):
    """The student's side of the link, and all endpoints of its process."""

    def __init__(
        self, scheduler: Scheduler, connection: socket.socket, refuse: Callable[[str], None]
    ) -> None:
        super().__init__()
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
        self.remotes: dict[int, RemoteEndpoint] = {}
        self._scheduler = scheduler
        self._connection = connection
        #: the processor core to share with the simulator from the first tick on; -1: any
        self.core = -1
        self._is_connected = self._has_started = False
        self._unannounced: dict[int, RemoteEndpoint] = {}
        self._flying = 0

    # Time -------------------------------------------------------------------------------------

    def advance(self, deadline_ns: int) -> None:
        """Let time move to what happens next: our deadline, or something from the simulator."""
        scheduler = self._scheduler
        if deadline_ns < (self.tick + 1) * TICK_NS:
            scheduler.set_now(max(deadline_ns, scheduler.now_ns))
            return
        self.settle()
        if not self._has_started:
            self._has_started = True
            cores.pin(self.core)
        if deadline_ns == NEVER:
            self.on_standstill()
        self._exchange(min(deadline_ns // TICK_NS, FOREVER), self._most())
        scheduler.set_now(max(scheduler.now_ns, self.tick * TICK_NS))
        self.on_arrival()

    def _most(self) -> int:
        if self.is_listening():
            return 1
        return BATCH_TICKS if any(reader.remote for reader in self.readers) else UNBOUNDED

    def synchronise(self) -> None:
        """Have the simulator take everything that we have sent, in no time."""
        if self._unannounced:
            self._exchange(self.tick, 0)

    def _exchange(self, target: int, most: int) -> None:
        while True:
            counts = [(remote.id, remote.sent) for remote in self._unannounced.values()]
            self._unannounced.clear()
            self._flying = 0
            self._send(Advance(target, most, counts))
            reply = self._receive(Reply)
            self._await(reply)
            self.tick = reply.tick
            if reply.state == State.RUNNING:
                return
            if reply.state == State.OVER:
                real.leave(0)
            # the simulator's endpoints have changed in the middle of a tick
            self._update(self._receive(Table))
            self.settle()

    def _await(self, reply: Reply) -> None:
        """Really wait for what the simulator says that it has sent."""
        awaited: list[Reader] = []
        for number, total in reply.sent:
            remote = self.remotes.get(number)
            if remote is None:
                self._break(ProtocolError(f"no endpoint has number {number}"))
                continue
            news, remote.sent = total - remote.sent, total
            for arrivals in distinct_arrivals(remote.readers):
                arrivals.expected += news
            awaited += remote.readers
        self._complain(self.await_arrivals(awaited, ARRIVAL_PATIENCE_S))

    def _complain(self, late: list[Reader]) -> None:
        for reader in late:
            missing = reader.arrivals.expected - reader.arrivals.received
            reader.arrivals.received = reader.arrivals.expected
            if missing > 0:
                self.note(Kind.WARNING, f"{missing} messages on {reader.channel} did not arrive")

    # Messages ---------------------------------------------------------------------------------

    def before_question(self) -> None:
        """Answers of DDS must not depend on how fast it is."""
        self.settle()
        self._scheduler.charge(QUESTION_UNITS)

    def before_send(self, writer: Writer) -> None:
        """Nothing is sent before those who should hear it are connected."""
        if self.changed:
            self.settle()

    def after_send(self, writer: Writer) -> None:
        """Count; deliver within this process; now and then have the simulator take it."""
        super().after_send(writer)
        for remote in writer.remote:
            remote.sent += 1
            self._unannounced[remote.id] = remote
            self._flying += 1
        if self._flying >= IN_FLIGHT:
            self.synchronise()
        if writer.local:
            self._complain(self.await_arrivals(writer.local, ARRIVAL_PATIENCE_S))
            self.on_arrival()
        self._scheduler.charge(SEND_UNITS)

    def request_destroy(self, endpoints: list[Endpoint], destroy: Callable[[], None]) -> None:
        """Nothing that was sent gets lost with its writer."""
        self.synchronise()
        for endpoint in endpoints:
            if isinstance(endpoint, Reader) and endpoint.channel.startswith("response"):
                asked = sum(
                    other.sent
                    for other in endpoints
                    if isinstance(other, Writer) and other.name == endpoint.name
                )
                endpoint.arrivals.received += (
                    asked - endpoint.received
                )  # nobody will take these answers
        super().request_destroy(endpoints, destroy)

    # Connections ------------------------------------------------------------------------------

    def settle(self) -> None:
        """Really wait until DDS has connected what belongs together."""
        if not self._is_connected:
            self._is_connected = True
            self._update(self._receive(Table))
        while self.changed:
            self.changed = False
            self._pair()
            matched = [(remote.id, self._partners(remote)) for remote in self.remotes.values()]
            publishers = sum(writer.is_stream for writer in self.writers)
            self._send(Hello([count for count in matched if count[1]], publishers))
            self._receive(Hello)
            self._await_matches()
            self.graph_epoch += 1

    def _update(self, table: Table) -> None:
        for number in table.removed:
            self.remotes.pop(number, None)
            self._unannounced.pop(number, None)
        for entry in table.added:
            qos = policies(entry.reliability, entry.durability)
            self.remotes[entry.id] = RemoteEndpoint(
                entry.channel, entry.type, qos, None, id=entry.id, writes=entry.writes
            )
        self.changed = True

    def _pair(self) -> None:
        self.pair_locally()
        remotes: dict[str, list[RemoteEndpoint]] = defaultdict(list)
        for remote in self.remotes.values():
            remotes[remote.channel].append(remote)
            remote.readers = []
        for reader in self.readers:
            before, reader.remote = reader.remote, []
            for remote in remotes[reader.channel]:
                if remote.writes and compatible(remote, reader):
                    reader.remote.append(remote)
                    remote.readers.append(reader)
                    if remote not in before and remote.sent and remembers(remote, reader):
                        reader.arrivals.expected += 1
        for writer in self.writers:
            readers = [remote for remote in remotes[writer.channel] if not remote.writes]
            writer.remote = [remote for remote in readers if compatible(writer, remote)]

    def _partners(self, remote: RemoteEndpoint) -> int:
        if remote.writes:
            return len(remote.readers)
        return sum(remote in writer.remote for writer in self.writers)

    def _await_matches(self) -> None:
        wanted: list[tuple[Endpoint, int]] = []
        for writer in self.writers:
            wanted.append((writer, len(writer.remote) + len(writer.local)))
        for reader in self.readers:
            wanted.append((reader, len(reader.remote) + self.local_writers(reader)))
        deadline = real.monotonic() + MATCH_PATIENCE_S
        while wanted := [(e, n) for e, n in wanted if e.matches and not e.matches(n)]:
            if real.monotonic() > deadline:
                for endpoint, number in wanted:
                    self.note(
                        Kind.WARNING, f"{endpoint.channel} was not connected to {number} others"
                    )
                return
            real.sleep(0.0002)
        history = [reader for reader in self.readers if reader.is_late]
        self._complain(self.await_arrivals(history, ARRIVAL_PATIENCE_S))

    # The link ---------------------------------------------------------------------------------

    def note(self, kind: Kind, text: str = "") -> None:
        """Tell the simulator something about this process."""
        self._send(Note(kind, text))

    def _send(self, packet: Packet) -> None:
        try:
            self._connection.send(encode(packet))
        except OSError:
            real.leave(1)

    def _receive(self, kind: type[Any]) -> Any:
        try:
            data = self._connection.recv(LIMIT_BYTES)
        except OSError:
            data = b""
        if not data:
            real.leave(1)
        try:
            packet = decode(data)
        except ProtocolError as error:
            self._break(error)
        if not isinstance(packet, kind):
            self._break(ProtocolError(f"{packet!r} where {kind.__name__} was expected"))
        return packet

    def _break(self, error: ProtocolError) -> None:
        """Somebody else has read or written here, and only the submission can."""
        self.refuse(f"broke our virtual time ({error!r})")
