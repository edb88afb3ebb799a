"""What this process sends and receives over DDS, counted; what has arrived waits here.

DDS delivers when it likes. So whatever arrives is taken at once into a reader of ours, as deep as
the one that the program asked for, and rclpy is served from there. Each side of the link says how
much it has sent, the other waits until it has received as much: then what a program sees depends
on virtual time alone. Used by both sides.

A channel is what in DDS is a topic: "topic /chatter", "request /clear", "response /clear".
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
class Endpoint:
    """A reader or writer of this process.

    Attributes:
        channel: what it is connected to.
        type: the ROS type, "geometry_msgs/msg/Twist".
        qos: its quality of service.
        matches: asks DDS whether exactly so many counterparts are known; None: nobody can tell.
    """

    channel: str
    type: str
    qos: QoSProfile
    matches: Callable[[int], bool] | None

    @property
    def name(self) -> str:
        """The ROS name, without the kind of channel."""
        return self.channel.partition(" ")[2]


@dataclass(eq=False)
class Writer(Endpoint):
    """A writer; `sent` counts its messages."""

    sent: int = 0
    #: topics without an answer, as pose, are no reason to stop ticking
    is_stream: bool = False
    #: set by the student's side: counterparts in the simulator and in this process
    remote: list[Any] = field(default_factory=list)
    local: list[Reader] = field(default_factory=list)


@dataclass(eq=False)
class Arrivals:
    """How much should have arrived and how much has; the readers of one response share it."""

    expected: int = 0
    received: int = 0


@dataclass(eq=False)
class Reader(Endpoint):
    """A reader; `items` have arrived and not been taken by the program, as `take` gives them."""

    take: Callable[[], Any] = lambda: None
    arrivals: Arrivals = field(default_factory=Arrivals)
    items: deque[Any] = field(default_factory=deque)
    #: of the arrivals, those that this reader received
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
            self.arrivals.received += 1
            self.received += 1

    def pop(self) -> Any:
        """The oldest item, or None."""
        return self.items.popleft() if self.items else None

    @property
    def is_late(self) -> bool:
        """Whether something that was sent has not arrived."""
        return self.arrivals.received < self.arrivals.expected


class EndpointRegistry:
    """All endpoints of this process. The two sides of the link derive from it."""

    def __init__(self) -> None:
        self.writers: list[Writer] = []
        self.readers: list[Reader] = []
        #: endpoints were added or removed, and the other side of the link does not know
        self.changed = False
        self._is_unpaired = False
        self.arrival_signal = ArrivalSignal()
        #: called with what the program does that virtual time cannot follow: "the submission ..."
        self.refuse: Callable[[str], None] = lambda what: None
        self._shared_arrivals: dict[str, Arrivals] = {}

    def shared_arrivals(self, channel: str) -> Arrivals:
        """What all readers on this channel count together."""
        return self._shared_arrivals.setdefault(channel, Arrivals())

    def add(self, endpoint: Endpoint) -> None:
        """A reader or writer was made."""
        self.changed = self._is_unpaired = True
        if isinstance(endpoint, Writer):
            self.writers.append(endpoint)
        elif isinstance(endpoint, Reader):
            self.readers.append(endpoint)

    def remove(self, endpoints: Iterable[Endpoint]) -> None:
        """Readers and writers are gone; removing one twice does no harm."""
        for endpoint in endpoints:
            of_its_kind: list[Any] = self.writers if isinstance(endpoint, Writer) else self.readers
            if endpoint in of_its_kind:
                of_its_kind.remove(endpoint)
                self.changed = self._is_unpaired = True

    def pair_locally(self) -> None:
        """Find which endpoints of this process are connected with each other."""
        if not self._is_unpaired:
            return
        self._is_unpaired = False
        readers: dict[str, list[Reader]] = defaultdict(list)
        for reader in self.readers:
            readers[reader.channel].append(reader)
        for writer in self.writers:
            writer.local = [i for i in readers.get(writer.channel, ()) if compatible(writer, i)]

    def local_writers(self, reader: Reader) -> int:
        """How many writers of this process a reader is connected with."""
        return sum(reader in writer.local for writer in self.writers)

    def before_question(self) -> None:
        """The program is about to ask DDS for its counterparts."""

    def before_send(self, writer: Writer) -> None:
        """A message is about to be sent."""
        self.pair_locally()

    def after_send(self, writer: Writer) -> None:
        """A message has been sent; DDS has already brought it to readers in this process."""
        writer.sent += 1
        for arrivals in distinct_arrivals(writer.local):
            arrivals.expected += 1

    def request_destroy(self, endpoints: list[Endpoint], destroy: Callable[[], None]) -> None:
        """The program wants to destroy these endpoints."""
        self.remove(endpoints)
        destroy()

    def await_arrivals(self, readers: Iterable[Reader], patience_s: float) -> list[Reader]:
        """Really wait until everything expected is here; returns those where it is not."""
        for reader in readers:
            reader.drain()
        late = [reader for reader in readers if reader.is_late]
        deadline = real.monotonic() + patience_s if late else 0.0
        while late:
            left = deadline - real.monotonic()
            if left <= 0:
                return late
            self.arrival_signal.wait(left)
            for reader in late:
                reader.drain()
            late = [reader for reader in late if reader.is_late]
        return []


def distinct_arrivals(readers: Iterable[Reader]) -> Iterable[Arrivals]:
    """The different ones: a response counts once, for whichever client it is."""
    return {id(reader.arrivals): reader.arrivals for reader in readers}.values()


class ArrivalSignal:
    """Given by DDS's own threads when something arrives.

    They call libc's eventfd_write(fd, number) directly, with the arguments that they have for a
    callback anyway. A Python callback would need the GIL while DDS holds a lock: a deadlock.
    """

    def __init__(self) -> None:
        self._fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        self._poll = select.poll()
        self._poll.register(self._fd, select.POLLIN)
        self._signal = ctypes.cast(ctypes.CDLL(None).eventfd_write, ctypes.c_void_p)

    def attach(self, function: str, pointer: int, library: str = "librcl.so") -> None:
        """Have rcl's `function` give the signal for the reader at `pointer`."""
        setter = getattr(ctypes.CDLL(library), function)
        setter.argtypes = [ctypes.c_void_p] * 3
        if setter(pointer, self._signal, self._fd) != 0:
            raise RuntimeError(f"{function} failed")

    def wait(self, patience_s: float) -> None:
        """Really wait for a signal."""
        if self._poll.poll(max(1, int(patience_s * 1000))):
            os.eventfd_read(self._fd)


def compatible(writer: Endpoint, reader: Endpoint) -> bool:
    """Whether DDS will connect the two, which are on the same channel."""
    if writer.type != reader.type:
        return False
    compatibility, _ = qos_check_compatible(writer.qos, reader.qos)
    return bool(compatibility != QoSCompatibility.ERROR)


def policies(reliability: int, durability: int) -> QoSProfile:
    """The quality of service of a simulator's endpoint, from what a table says about it."""
    return QoSProfile(
        depth=DEPTH,
        reliability=QoSReliabilityPolicy(reliability),
        durability=QoSDurabilityPolicy(durability),
    )
