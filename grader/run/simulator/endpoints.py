"""The simulator's mail in a run in virtual time: every end has a number, and is accounted for."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from grader.run.lockstep.protocol import Counts, Endpoint, Table
from grader.run.lockstep.registry import End, Inbox, Office, Outlet, tallies

#: How long DDS may take to deliver a message that was announced [s].
ARRIVAL_PATIENCE_S = 1.0
#: A wire on which so often something announced did not come is not waited for any more.
MOST_LIES = 3
#: More messages between two handshakes than any host announces.
MOST_NEWS = 1_000


class Desk(Office):
    """The simulator's mail: every end has a number, by which the student's side knows it."""

    def __init__(self) -> None:
        super().__init__()
        self.ends: dict[int, End] = {}
        self.answered = False
        self._numbers: dict[End, int] = {}
        self._told: dict[End, int] = {}
        self._lies: dict[End, int] = {}
        self._touched: dict[Outlet, None] = {}
        self._added: list[Endpoint] = []
        self._removed: list[int] = []
        self._graves: list[Callable[[], None]] = []

    def add(self, end: End) -> None:
        """Number a new end."""
        super().add(end)
        number = self._numbers[end] = len(self._numbers) + 1
        self.ends[number] = end
        self._told[end] = 0
        policies = (int(end.qos.reliability), int(end.qos.durability))
        writes = isinstance(end, Outlet)
        self._added.append(Endpoint(number, end.wire, end.type, writes, *policies))

    def remove(self, ends: Any) -> None:
        """Strike out ends; their last messages may still be announced."""
        gone = [end for end in ends if self.ends.pop(self._numbers[end], None)]
        super().remove(gone)
        self._removed += [self._numbers[end] for end in gone]

    def retire(self, ends: list[End], destroy: Callable[[], None]) -> None:
        """Destroy only after the other side has received what was sent."""
        self.remove(ends)
        self._graves.append(destroy)

    def bury(self) -> None:
        """Destroy what was retired."""
        for destroy in self._graves:
            destroy()
        self._graves.clear()

    def table(self) -> Table:
        """What has changed since the last table."""
        self.changed = False
        gone = set(self._removed)
        added = tuple(entry for entry in self._added if entry.id not in gone)
        table = Table(added, tuple(self._removed))
        self._added, self._removed = [], []
        return table

    def after_send(self, outlet: Outlet) -> None:
        """Remember to announce it."""
        super().after_send(outlet)
        self._touched[outlet] = None
        self.answered = self.answered or not outlet.is_stream

    def news(self) -> Counts:
        """The totals of what was sent since the last call."""
        counts = [(self._numbers[outlet], outlet.sent) for outlet in self._touched]
        self._touched.clear()
        self.answered = False
        return counts

    def expect(self, sent: Counts) -> list[Inbox]:
        """Wait for what was announced; returns where it did not come."""
        awaited = []
        for number, total in sent:
            end = self.ends.get(number)
            if not isinstance(end, Inbox) or not 0 <= total - self._told[end] <= MOST_NEWS:
                continue
            for tally in tallies([end]):
                tally.expected += total - self._told[end]
            self._told[end] = total
            awaited.append(end)
        patience = [end for end in awaited if self._lies.get(end, 0) < MOST_LIES]
        late = self.await_arrivals(patience, ARRIVAL_PATIENCE_S)
        for inbox in late:
            self._lies[inbox] = self._lies.get(inbox, 0) + 1
            inbox.tally.expected = inbox.tally.received
        return late

    def has_mail(self) -> bool:
        """Whether something waits to be served."""
        return any(inbox.items for inbox in self.inboxes)

    def await_matches(self, matched: Counts, deadline: float) -> bool:
        """Wait until DDS knows as many counterparts as the other side says; False if in vain."""
        counts = dict(matched)
        wanted = []
        for number, end in self.ends.items():
            local = self.local_writers(end) if isinstance(end, Inbox) else 0
            local = len(end.local) if isinstance(end, Outlet) else local
            wanted.append((end, counts.get(number, 0) + local))
        while wanted := [(e, n) for e, n in wanted if e.matches and not e.matches(n)]:
            if time.monotonic() > deadline:
                return False
            time.sleep(0.0002)
        return True
