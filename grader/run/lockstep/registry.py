"""The readers and writers of this process, and the messages that have arrived in them.

rclpy makes its entities in DDS as ever, but no message goes that way: DDS delivers when it likes.
A message goes, in the bytes that DDS would carry, to the readers of this process at once, and over
the link to those of the other (`protocol`). So what a program sees depends on virtual time alone.
Used by both sides.

A channel is what in DDS is a topic: "topic /chatter", "request /clear", "response /clear".
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

from rclpy.qos import (
    QoSCompatibility,
    QoSDurabilityPolicy,
    QoSHistoryPolicy,
    QoSProfile,
    QoSReliabilityPolicy,
    qos_check_compatible,
)

from grader.message import Message

Kind = TypeVar("Kind", bound="Endpoint")


@dataclass(eq=False, slots=True)
class Arrived:
    """A message in a reader.

    Attributes:
        data: in CDR.
        time_ns: when it was sent, on the clock of the run.
        number: of a request, or which of a topic's messages it is.
        client: the client of a request: its reader for responses in this process, or the number
            by which the other process knows it; None for a topic.
    """

    data: bytes
    time_ns: int
    number: int
    client: Reader | int | None = None


@dataclass(eq=False)
class Endpoint:
    """A reader or writer of this process, or on the student's side one of the simulator's.

    Attributes:
        channel: what it is connected to.
        type: the ROS type, "geometry_msgs/msg/Twist"; of a service, that of the whole.
        qos: its quality of service.
        number: by which the student's side knows one of the simulator's.
        matches, unfit: how many counterparts it has had in all, here and in the simulator: those
            that DDS connects, and those whose quality of service does not fit.
        matched: how many of the former it has. All three are counted on the student's side.
        node: the name of its node, with the namespace.
        is_hidden: it only records: neither counts nor graphs show it.
    """

    channel: str
    type: str
    qos: QoSProfile
    number: int = 0
    matches: int = 0
    unfit: int = 0
    matched: int = 0
    node: str = "/"
    is_hidden: bool = False

    @property
    def name(self) -> str:
        """The ROS name, without the kind of channel."""
        return self.channel.partition(" ")[2]

    @property
    def kind(self) -> str:
        """The kind of channel: topic, request, response."""
        return self.channel.partition(" ")[0]

    @property
    def is_lasting(self) -> bool:
        """Whether late readers get a writer's last messages, or a reader wants them."""
        return bool(self.qos.durability == QoSDurabilityPolicy.TRANSIENT_LOCAL)


@dataclass(eq=False)
class Reader(Endpoint):
    """A reader; `items` have arrived and were not yet read by the program.

    Attributes:
        message: the class of its messages.
        awaited: of a client's, how many responses from the other process are still to come.
        hears: whether it hears the other process's on a topic, or its requests.
    """

    message: Any = None
    items: deque[Arrived] = field(default_factory=deque)
    awaited: int = 0
    hears: bool = False

    def __post_init__(self) -> None:
        if self.qos.history != QoSHistoryPolicy.KEEP_ALL:
            self.items = deque(maxlen=max(1, self.qos.depth))

    def pop(self) -> Arrived | None:
        """The oldest item, or None."""
        return self.items.popleft() if self.items else None


@dataclass(eq=False)
class Writer(Endpoint):
    """A writer.

    Attributes:
        sent: how many messages it has sent.
        is_stream: a topic without an answer, as pose, is no reason to stop ticking.
        history: what late readers get.
        local: the readers of this process that hear it.
        remote: the other process's readers that hear it, as far as they are known.
    """

    sent: int = 0
    is_stream: bool = False
    history: deque[Arrived] = field(default_factory=deque)
    local: list[Reader] = field(default_factory=list)
    remote: list[Reader] = field(default_factory=list)

    def __post_init__(self) -> None:
        if self.qos.history != QoSHistoryPolicy.KEEP_ALL:
            self.history = deque(maxlen=max(1, self.qos.depth))


class EndpointRegistry:
    """All endpoints of this process. The two sides of the link derive from it.

    Attributes:
        others: on the student's side the simulator's endpoints, by their numbers.
    """

    def __init__(self, now_ns: Callable[[], int]) -> None:
        """`now_ns` returns the time that messages are stamped with."""
        self.writers: list[Writer] = []
        self.readers: list[Reader] = []
        self.others: dict[int, Endpoint] = {}
        #: endpoints were added or removed, and the other side of the link does not know
        self.changed = False
        #: called with what the program does that virtual time cannot follow: "the submission ..."
        self.refuse: Callable[[Message], None] = lambda what: None
        self.now_ns = now_ns
        self._is_unpaired = False
        #: which have ever been on one channel, with the same type
        self._met: set[tuple[Endpoint, Endpoint]] = set()

    # Which there are --------------------------------------------------------------------------

    def add(self, endpoint: Endpoint) -> None:
        """Register a new reader or writer."""
        self.changed = self._is_unpaired = True
        if isinstance(endpoint, Writer):
            self.writers.append(endpoint)
        elif isinstance(endpoint, Reader):
            self.readers.append(endpoint)

    def remove(self, endpoints: Iterable[Endpoint]) -> None:
        """Remove readers and writers; removing one twice does no harm."""
        for endpoint in endpoints:
            of_its_kind: list[Any] = self.writers if isinstance(endpoint, Writer) else self.readers
            if endpoint in of_its_kind:
                of_its_kind.remove(endpoint)
                self.changed = self._is_unpaired = True

    def pair(self) -> None:
        """Find which endpoints are connected with each other; late readers get what is kept."""
        if not self._is_unpaired:
            return
        self._is_unpaired = False
        local = _by_channel(each for each in self.readers if not each.is_hidden)
        remote = _by_channel(_of_kind(Reader, self.others))
        theirs = _of_kind(Writer, self.others)
        for writer in (*self.writers, *theirs):
            before = writer.local
            writer.local = [each for each in local[writer.channel] if compatible(writer, each)]
            if writer.is_lasting:
                for reader in writer.local:
                    if reader not in before and reader.is_lasting:
                        reader.items.extend(writer.history)
        for writer in self.writers:
            writer.remote = [each for each in remote[writer.channel] if compatible(writer, each)]
        heard = {reader for writer in theirs for reader in writer.local}
        for reader in self.readers:
            reader.hears = reader in heard and reader.kind != "response"

    def count_meetings(self) -> None:
        """Count the matched endpoints of each topic, and those matched for the first time."""
        others = self.others.values()
        for endpoint in (*self.writers, *self.readers, *others):
            endpoint.matched = 0
        theirs = (each for each in _of_kind(Reader, self.others) if not each.is_hidden)
        hearing = _by_channel([*self.readers, *theirs])
        for writer in (*self.writers, *_of_kind(Writer, self.others)):
            for reader in hearing[writer.channel]:
                if writer.type != reader.type:
                    continue
                is_new = (writer, reader) not in self._met
                self._met.add((writer, reader))
                fits = suits(writer, reader)
                for endpoint in (writer, reader):
                    endpoint.matched += fits
                    endpoint.matches += fits and is_new
                    endpoint.unfit += is_new and not fits

    def connect(self) -> None:
        """Connect what belongs together; before anything is sent."""
        self.pair()

    def before_question(self) -> None:
        """Called before the program asks for its counterparts."""
        self.pair()

    def count_readers(self, writer: Writer) -> int:
        """Return how many readers hear a writer."""
        return len(writer.local) + sum(not each.is_hidden for each in writer.remote)

    def count_writers(self, reader: Reader) -> int:
        """Return how many writers a reader hears."""
        writers = (*self.writers, *_of_kind(Writer, self.others))
        return sum(reader in writer.local for writer in writers)

    # Messages ---------------------------------------------------------------------------------

    def publish(self, writer: Writer, data: bytes) -> None:
        """Send a message to all readers of the topic, after `connect`."""
        writer.sent += 1
        self.deliver(writer, Arrived(data, self.now_ns(), writer.sent))

    def deliver(self, writer: Writer, arrived: Arrived) -> None:
        """Deliver a writer's message to the readers of this process."""
        if writer.is_lasting:
            writer.history.append(arrived)
        for reader in writer.local:
            reader.items.append(arrived)

    def ask(self, writer: Writer, client: Reader, data: bytes) -> int:
        """Send a client's request, after `connect`; return its number.

        The response comes into `client`.
        """
        writer.sent += 1
        for reader in writer.local:
            reader.items.append(Arrived(data, self.now_ns(), writer.sent, client))
        return writer.sent

    def respond(self, writer: Writer, to: Arrived, data: bytes) -> None:
        """Send the response to a request."""
        writer.sent += 1
        if isinstance(to.client, Reader):
            to.client.items.append(Arrived(data, self.now_ns(), to.number))


def _by_channel(readers: Iterable[Reader]) -> dict[str, list[Reader]]:
    found: dict[str, list[Reader]] = defaultdict(list)
    for reader in readers:
        found[reader.channel].append(reader)
    return found


def _of_kind(kind: type[Kind], endpoints: Mapping[int, Endpoint]) -> list[Kind]:
    return [each for each in endpoints.values() if isinstance(each, kind)]


def compatible(writer: Endpoint, reader: Endpoint) -> bool:
    """Whether DDS connects the two, which are on the same channel."""
    return writer.type == reader.type and suits(writer, reader)


def suits(writer: Endpoint, reader: Endpoint) -> bool:
    """Whether a writer offers the quality of service that a reader requests."""
    compatibility, _ = qos_check_compatible(writer.qos, reader.qos)
    return bool(compatibility != QoSCompatibility.ERROR)


def policies(reliability: int, durability: int, depth: int) -> QoSProfile:
    """Return the quality of service of a simulator's endpoint, from its entry in a table."""
    return QoSProfile(
        depth=depth,
        reliability=QoSReliabilityPolicy(reliability),
        durability=QoSDurabilityPolicy(durability),
    )
