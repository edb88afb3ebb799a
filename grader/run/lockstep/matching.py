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
    QoSPolicyKind,
    QoSProfile,
    QoSReliabilityPolicy,
    qos_check_compatible,
)

from grader.run.lockstep.protocol import EPOCH_NS, SHIFT, EndpointInfo, Parcel, Table
from grader.text.message import Message

#: The depth of another process's queue, at most: rclpy's C++ takes no more than an int.
MOST_DEPTH = 1 << 20

Kind = TypeVar("Kind", bound="Endpoint")


@dataclass(eq=False, slots=True)
class Arrived:
    """A message in a reader.

    Attributes:
        data: in CDR.
        time_ns: when it was sent, on the clock of the run.
        number: of a request, or which of a topic's messages it is.
        client: the client of a request: its reader for responses in this process, or the number of
            one in another; None for a topic.
    """

    data: bytes
    time_ns: int
    number: int
    client: Reader | int | None = None


@dataclass(eq=False)
class Endpoint:
    """A node, reader or writer of this process or of another.

    Attributes:
        channel: what it is connected to.
        type: the ROS type, "geometry_msgs/msg/Twist"; of a service, that of the whole.
        qos: its quality of service.
        number: by which all processes know it.
        matches, unfit: how many counterparts it has had in all, in any process: those that DDS
            connects, and those whose quality of service does not fit.
        matched: how many of the former it has. All three are counted on the student's side.
        policy: the policy that did not fit the last of the latter.
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
    policy: QoSPolicyKind = QoSPolicyKind.INVALID
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

    def info(self) -> EndpointInfo:
        """Return its entry in a table."""
        qos = self.qos
        policies = int(qos.reliability), int(qos.durability), max(0, qos.depth)
        writes = isinstance(self, Writer) or (isinstance(self, NodeEntry) and self.logs)
        return EndpointInfo(
            *(self.node, self.channel, self.type, writes, *policies, self.number, self.is_hidden)
        )

    @property
    def is_lasting(self) -> bool:
        """Whether late readers get a writer's last messages, or a reader wants them."""
        return bool(self.qos.durability == QoSDurabilityPolicy.TRANSIENT_LOCAL)


@dataclass(eq=False)
class NodeEntry(Endpoint):
    """A node.

    Attributes:
        logs: whether it publishes on /rosout, by rclpy's C++.
    """

    logs: bool = True


@dataclass(eq=False)
class Reader(Endpoint):
    """A reader; `items` have arrived and were not yet read by the program.

    Attributes:
        message: the class of its messages.
        awaited: of a client's, how many responses from other processes are still to come.
        hears: whether it hears others' messages on a topic, or their requests.
    """

    message: Any = None
    items: deque[Arrived] = field(default_factory=deque)
    awaited: int = 0
    hears: bool = False

    def __post_init__(self) -> None:
        if self.qos.history != QoSHistoryPolicy.KEEP_ALL:
            self.items = deque(maxlen=max(1, self.qos.depth))

    def pop(self) -> Arrived | None:
        return self.items.popleft() if self.items else None


@dataclass(eq=False)
class Writer(Endpoint):
    """A writer.

    Attributes:
        sent: how many messages it has sent.
        is_stream: a topic without an answer, as pose, is no reason to stop ticking.
        history: what late readers get.
        local: the readers of this process that hear it.
        remote: the readers of other processes that hear it, as far as they are known.
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
        nodes, writers, readers: those that it has now.
        own: all of these, by their numbers.
        others: those of other processes, in the same way.
    """

    def __init__(self, now_ns: Callable[[], int], member: int = 0) -> None:
        """Begin without any.

        Args:
            now_ns: returns the time that messages are stamped with.
            member: the number of this process; 0 for the simulator.
        """
        self.nodes: list[Endpoint] = []
        self.writers: list[Writer] = []
        self.readers: list[Reader] = []
        self.own: dict[int, Endpoint] = {}
        self.others: dict[int, Endpoint] = {}
        self._last_number = member << SHIFT
        self._added: dict[int, EndpointInfo] = {}
        self._removed: list[int] = []
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
        """Register a new node, reader or writer, and number it."""
        self.changed = self._is_unpaired = True
        endpoint.number = self._last_number = self._last_number + 1
        self.own[endpoint.number] = endpoint
        self._of_its_kind(endpoint).append(endpoint)
        self._added[endpoint.number] = endpoint.info()

    def remove(self, endpoints: Iterable[Endpoint]) -> None:
        """Remove some; removing one twice does no harm."""
        for endpoint in endpoints:
            if self.own.pop(endpoint.number, None) is None:
                continue
            self.changed = self._is_unpaired = True
            self._of_its_kind(endpoint).remove(endpoint)
            if self._added.pop(endpoint.number, None) is None:
                self._removed.append(endpoint.number)

    def _of_its_kind(self, endpoint: Endpoint) -> list[Any]:
        if isinstance(endpoint, Writer):
            return self.writers
        return self.readers if isinstance(endpoint, Reader) else self.nodes

    def pop_table(self) -> Table:
        """Return the changes since the last table."""
        self.changed = False
        table = Table(tuple(self._added.values()), tuple(self._removed))
        self._added, self._removed = {}, []
        return table

    def add_others(self, table: Table) -> None:
        """Add what is new in another process."""
        for entry in table.added:
            self.others[entry.id] = other_endpoint(entry)
        self._is_unpaired = True

    def remove_others(self, numbers: Iterable[int]) -> None:
        """Remove what has gone in another process."""
        for number in numbers:
            self.others.pop(number, None)
        self._is_unpaired = True

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
                    if is_new and not fits:
                        endpoint.unfit += 1
                        endpoint.policy = _unfit(writer.qos, reader.qos)

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
        self.send_to_others(writer, data)
        self.note_sent(data, is_local=bool(writer.local))

    def send_to_others(self, writer: Writer, data: bytes) -> None:
        """Send a topic's message to the readers in other processes."""
        for remote in writer.remote:
            self.send(remote.number, 0, writer.sent, data)

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
        number = writer.sent = writer.sent + 1
        for reader in writer.local:
            reader.items.append(Arrived(data, self.now_ns(), number, client))
        for remote in writer.remote:
            client.awaited += 1
            self.send(remote.number, client.number, number, data)
        self.note_sent(data, is_local=bool(writer.local))
        return number

    def respond(self, writer: Writer, to: Arrived, data: bytes) -> None:
        """Send the response to a request."""
        writer.sent += 1
        if isinstance(to.client, Reader):
            to.client.items.append(Arrived(data, self.now_ns(), to.number))
        elif to.client is not None:
            self.send(to.client, 0, to.number, data)
        self.note_sent(data, is_local=isinstance(to.client, Reader))

    def send(self, to: int, client: int, number: int, data: bytes) -> None:
        """Send a message to another process; the values are those of a `Parcel`."""
        self.send_parcel(Parcel(to, client, number, self.now_ns() - EPOCH_NS, data))

    def send_parcel(self, parcel: Parcel) -> None:
        """Send a message over the link of this side."""
        raise NotImplementedError

    def note_sent(self, data: bytes, *, is_local: bool) -> None:
        """Called after each message; `is_local`: a reader of this process has it."""


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


def _unfit(offered: QoSProfile, requested: QoSProfile) -> QoSPolicyKind:
    """Return the policy that DDS names where one or two do not fit."""
    reliable = QoSReliabilityPolicy.RELIABLE
    is_reliability = requested.reliability == reliable != offered.reliability
    return QoSPolicyKind.RELIABILITY if is_reliability else QoSPolicyKind.DURABILITY


def other_endpoint(entry: EndpointInfo) -> Endpoint:
    """Return a node, reader or writer of another process, from its entry in a table."""
    qos = QoSProfile(
        depth=min(max(1, entry.depth), MOST_DEPTH),
        reliability=QoSReliabilityPolicy(entry.reliability),
        durability=QoSDurabilityPolicy(entry.durability),
    )
    facts = (entry.channel, entry.type, qos, entry.id)
    made: Endpoint
    if entry.channel.startswith("node "):
        made = NodeEntry(*facts, logs=entry.writes)
    else:
        made = Writer(*facts) if entry.writes else Reader(*facts)
    made.node, made.is_hidden = entry.node, entry.is_hidden
    return made
