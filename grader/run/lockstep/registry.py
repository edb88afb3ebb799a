"""What this process sends and receives over DDS, counted; what has arrived waits in our inboxes.

DDS delivers when it likes. So whatever arrives is taken at once into an inbox, as deep as the
reader that the program asked for, and rclpy is served from there. Each side of the link says how
much it has sent, the other waits until it has received as much: then what a program sees depends
on virtual time alone. Used by both sides.

A wire is what in DDS is a topic: "topic /turtle1/pose", "request /clear", "response /clear".
"""

from __future__ import annotations

import ctypes
import os
import select
from collections import defaultdict, deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

from rclpy.qos import (
    QoSCompatibility,
    QoSDurabilityPolicy,
    QoSHistoryPolicy,
    QoSProfile,
    QoSReliabilityPolicy,
    qos_check_compatible,
)

from grader.run.lockstep import real

#: How deep the readers underneath really are; more is never on its way (see IN_FLIGHT).
DEPTH = 128
#: After so many messages without an answer the receiver is asked to take them.
IN_FLIGHT = 64


@dataclass(eq=False)
class End:
    """A reader or writer of this process.

    Attributes:
        wire: what it is connected to.
        type: the ROS type, "geometry_msgs/msg/Twist".
        qos: its quality of service.
        matches: asks DDS whether exactly so many counterparts are known; None: nobody can tell.
    """

    wire: str
    type: str
    qos: QoSProfile
    matches: Callable[[int], bool] | None

    @property
    def name(self) -> str:
        """The ROS name, without the kind of wire."""
        return self.wire.partition(" ")[2]


@dataclass(eq=False)
class Outlet(End):
    """A writer; `sent` counts its messages."""

    sent: int = 0
    #: topics without an answer, as pose, are no reason to stop ticking
    is_stream: bool = False
    #: set by the student's side: counterparts in the simulator and in this process
    remote: list[Any] = field(default_factory=list)
    local: list[Inbox] = field(default_factory=list)


@dataclass(eq=False)
class Tally:
    """How much should have arrived and how much has; the readers of one response share it."""

    expected: int = 0
    received: int = 0


@dataclass(eq=False)
class Inbox(End):
    """A reader; `items` have arrived and not been taken by the program, as `take` gives them."""

    take: Callable[[], Any] = lambda: None
    tally: Tally = field(default_factory=Tally)
    items: deque[Any] = field(default_factory=deque)
    #: of the tally's, those that this inbox received
    received: int = 0
    #: set by the student's side: counterparts in the simulator
    remote: list[Any] = field(default_factory=list)

    def __post_init__(self) -> None:
        if self.qos.history != QoSHistoryPolicy.KEEP_ALL:
            self.items = deque(maxlen=max(1, self.qos.depth))

    def drain(self) -> None:
        """Take everything that DDS has."""
        while (item := self.take()) is not None:
            self.items.append(item)
            self.tally.received += 1
            self.received += 1

    def pop(self) -> Any:
        """The oldest item, or None."""
        return self.items.popleft() if self.items else None

    @property
    def is_late(self) -> bool:
        """Whether something that was sent has not arrived."""
        return self.tally.received < self.tally.expected


class Office:
    """All ends of this process. The two sides of the link derive from it."""

    def __init__(self) -> None:
        self.outlets: list[Outlet] = []
        self.inboxes: list[Inbox] = []
        #: ends were added or removed, and the other side of the link does not know
        self.changed = False
        self._is_unpaired = False
        self.bell = Doorbell()
        self.tallies: dict[str, Tally] = {}

    def tally(self, wire: str) -> Tally:
        """The tally that all inboxes on this wire share."""
        return self.tallies.setdefault(wire, Tally())

    def add(self, end: End) -> None:
        """A reader or writer was made."""
        self.changed = self._is_unpaired = True
        if isinstance(end, Outlet):
            self.outlets.append(end)
        elif isinstance(end, Inbox):
            self.inboxes.append(end)

    def remove(self, ends: Iterable[End]) -> None:
        """Readers and writers are gone; removing one twice does no harm."""
        for end in ends:
            of_its_kind: list[Any] = self.outlets if isinstance(end, Outlet) else self.inboxes
            if end in of_its_kind:
                of_its_kind.remove(end)
                self.changed = self._is_unpaired = True

    def pair_locally(self) -> None:
        """Find which ends of this process are connected with each other."""
        if not self._is_unpaired:
            return
        self._is_unpaired = False
        inboxes: dict[str, list[Inbox]] = defaultdict(list)
        for inbox in self.inboxes:
            inboxes[inbox.wire].append(inbox)
        for outlet in self.outlets:
            outlet.local = [i for i in inboxes.get(outlet.wire, ()) if compatible(outlet, i)]

    def local_writers(self, inbox: Inbox) -> int:
        """How many writers of this process an inbox is connected with."""
        return sum(inbox in outlet.local for outlet in self.outlets)

    def before_question(self) -> None:
        """The program is about to ask DDS for its counterparts."""

    def before_send(self, outlet: Outlet) -> None:
        """A message is about to be sent."""
        self.pair_locally()

    def after_send(self, outlet: Outlet) -> None:
        """A message has been sent; DDS has already brought it to readers in this process."""
        outlet.sent += 1
        for tally in tallies(outlet.local):
            tally.expected += 1

    def retire(self, ends: list[End], destroy: Callable[[], None]) -> None:
        """The program wants to destroy these ends."""
        self.remove(ends)
        destroy()

    def await_arrivals(self, inboxes: Iterable[Inbox], patience_s: float) -> list[Inbox]:
        """Really wait until everything expected is here; returns those where it is not."""
        for inbox in inboxes:
            inbox.drain()
        late = [inbox for inbox in inboxes if inbox.is_late]
        deadline = real.monotonic() + patience_s if late else 0.0
        while late:
            left = deadline - real.monotonic()
            if left <= 0:
                return late
            self.bell.wait(left)
            for inbox in late:
                inbox.drain()
            late = [inbox for inbox in late if inbox.is_late]
        return []


def tallies(inboxes: Iterable[Inbox]) -> Iterable[Tally]:
    """The different ones: a response counts once, for whichever client it is."""
    return {id(inbox.tally): inbox.tally for inbox in inboxes}.values()


class Doorbell:
    """Rung by DDS's own threads when something arrives.

    They call libc's eventfd_write(fd, number) directly, with the arguments that they have for a
    callback anyway. A Python callback would need the GIL while DDS holds a lock: a deadlock.
    """

    def __init__(self) -> None:
        self._fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        self._poll = select.poll()
        self._poll.register(self._fd, select.POLLIN)
        self._ring = ctypes.cast(ctypes.CDLL(None).eventfd_write, ctypes.c_void_p)

    def hang(self, function: str, pointer: int, library: str = "librcl.so") -> None:
        """Have rcl's `function` ring for the reader at `pointer`."""
        setter = getattr(ctypes.CDLL(library), function)
        setter.argtypes = [ctypes.c_void_p] * 3
        if setter(pointer, self._ring, self._fd) != 0:
            raise RuntimeError(f"{function} failed")

    def wait(self, patience_s: float) -> None:
        """Really wait for a ring."""
        if self._poll.poll(max(1, int(patience_s * 1000))):
            os.eventfd_read(self._fd)


def compatible(writer: End, reader: End) -> bool:
    """Whether DDS will connect the two, which are on the same wire."""
    if writer.type != reader.type:
        return False
    compatibility, _ = qos_check_compatible(writer.qos, reader.qos)
    return bool(compatibility != QoSCompatibility.ERROR)


def policies(reliability: int, durability: int) -> QoSProfile:
    """The quality of service of a simulator's end, from what a table says about it."""
    return QoSProfile(
        depth=DEPTH,
        reliability=QoSReliabilityPolicy(reliability),
        durability=QoSDurabilityPolicy(durability),
    )
