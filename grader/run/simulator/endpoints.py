"""The simulator's readers and writers in virtual time: numbered, and their messages counted."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from grader.run.lockstep.protocol import Counts, EndpointInfo, Table
from grader.run.lockstep.registry import (
    Endpoint,
    EndpointRegistry,
    Reader,
    Writer,
    distinct_arrivals,
)

#: How long DDS may take to deliver a message that was announced [s].
ARRIVAL_PATIENCE_S = 1.0
#: A channel on which so often something announced did not come is not waited for any more.
MOST_MISSED = 3
#: More messages between two handshakes than any submission's process of ours announces.
MOST_ANNOUNCED = 1_000


class SimulatorEndpoints(EndpointRegistry):
    """All of them, with the numbers by which the student's side knows them."""

    def __init__(self) -> None:
        super().__init__()
        self.by_number: dict[int, Endpoint] = {}
        self.answered = False
        self._numbers: dict[Endpoint, int] = {}
        self._announced: dict[Endpoint, int] = {}
        self._missed: dict[Endpoint, int] = {}
        self._unannounced: dict[Writer, None] = {}
        self._added: list[EndpointInfo] = []
        self._removed: list[int] = []
        self._pending_destroys: list[Callable[[], None]] = []

    def add(self, endpoint: Endpoint) -> None:
        """Number a new endpoint."""
        super().add(endpoint)
        number = self._numbers[endpoint] = len(self._numbers) + 1
        self.by_number[number] = endpoint
        self._announced[endpoint] = 0
        policies = (int(endpoint.qos.reliability), int(endpoint.qos.durability))
        writes = isinstance(endpoint, Writer)
        self._added.append(EndpointInfo(number, endpoint.channel, endpoint.type, writes, *policies))

    def remove(self, endpoints: Any) -> None:
        """Strike out endpoints; their last messages may still be announced."""
        gone = [
            endpoint for endpoint in endpoints if self.by_number.pop(self._numbers[endpoint], None)
        ]
        super().remove(gone)
        self._removed += [self._numbers[endpoint] for endpoint in gone]

    def request_destroy(self, endpoints: list[Endpoint], destroy: Callable[[], None]) -> None:
        """Destroy only after the other side has received what was sent."""
        self.remove(endpoints)
        self._pending_destroys.append(destroy)

    def destroy_pending(self) -> None:
        """Destroy what was retired."""
        for destroy in self._pending_destroys:
            destroy()
        self._pending_destroys.clear()

    def table(self) -> Table:
        """What has changed since the last table."""
        self.changed = False
        gone = set(self._removed)
        added = tuple(entry for entry in self._added if entry.id not in gone)
        table = Table(added, tuple(self._removed))
        self._added, self._removed = [], []
        return table

    def after_send(self, writer: Writer) -> None:
        """Remember to announce it."""
        super().after_send(writer)
        self._unannounced[writer] = None
        self.answered = self.answered or not writer.is_stream

    def take_sent_counts(self) -> Counts:
        """The totals of what was sent since the last call."""
        counts = [(self._numbers[writer], writer.sent) for writer in self._unannounced]
        self._unannounced.clear()
        self.answered = False
        return counts

    def await_announced(self, sent: Counts) -> list[Reader]:
        """Wait for what was announced; returns where it did not come."""
        awaited = []
        for number, total in sent:
            endpoint = self.by_number.get(number)
            if (
                not isinstance(endpoint, Reader)
                or not 0 <= total - self._announced[endpoint] <= MOST_ANNOUNCED
            ):
                continue
            for arrivals in distinct_arrivals([endpoint]):
                arrivals.expected += total - self._announced[endpoint]
            self._announced[endpoint] = total
            awaited.append(endpoint)
        patience = [endpoint for endpoint in awaited if self._missed.get(endpoint, 0) < MOST_MISSED]
        late = self.await_arrivals(patience, ARRIVAL_PATIENCE_S)
        for reader in late:
            self._missed[reader] = self._missed.get(reader, 0) + 1
            reader.arrivals.expected = reader.arrivals.received
        return late

    def has_unread(self) -> bool:
        """Whether something waits to be served."""
        return any(reader.items for reader in self.readers)

    def await_matches(self, matched: Counts, deadline: float) -> bool:
        """Wait until DDS knows as many counterparts as the other side says; False if in vain."""
        counts = dict(matched)
        wanted = []
        for number, endpoint in self.by_number.items():
            local = self.local_writers(endpoint) if isinstance(endpoint, Reader) else 0
            local = len(endpoint.local) if isinstance(endpoint, Writer) else local
            wanted.append((endpoint, counts.get(number, 0) + local))
        while wanted := [(e, n) for e, n in wanted if e.matches and not e.matches(n)]:
            if time.monotonic() > deadline:
                return False
            time.sleep(0.0002)
        return True
