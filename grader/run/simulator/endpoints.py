"""The simulator's readers and writers in virtual time, with their outgoing messages."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, Final

from rclpy.qos import QoSHistoryPolicy, QoSProfile, QoSReliabilityPolicy

from grader.run.lockstep.endpoints import deserialized
from grader.run.lockstep.matching import (
    Arrived,
    EndpointRegistry,
    NodeEntry,
    Reader,
    Writer,
)
from grader.run.lockstep.protocol import (
    SHIFT,
    EndpointInfo,
    Parcel,
    Parcels,
    Table,
)
from grader.text.message import Message, msg

#: The longest message that a reader accepts [bytes]; DDS has no limit, but no parameter is longer.
LONGEST_MESSAGE: Final = 2_000_000
#: So much may lie in all readers [bytes]; beyond it nothing longer than LARGE is accepted.
MOST_UNREAD, LARGE = 64_000_000, 4_096
#: So much may wait for the student's side [bytes] before a reply sends it.
MOST_OUTGOING = 32_000_000
#: Nodes, readers and writers of the student's side at once; a node of rclpy's has ten.
MOST_ENDPOINTS = 10_000
#: Different topics of the student's side that are kept for the result.
MOST_TOPICS = 1_000

_TOO_MUCH = msg("messages on {channel} were too long or too many to be taken")


class SimulatorEndpoints(EndpointRegistry):
    """The simulator's endpoints, with the numbers by which the student's side knows them.

    Attributes:
        published: the topics on which the student's side has published: topic -> type.
        theirs: its readers and writers, as a recording knows them.
    """

    def __init__(self, now_ns: Callable[[], int], flag: Callable[[Message], None]) -> None:
        """`flag` is called with remarks for the result."""
        super().__init__(now_ns)
        self._flag = flag
        #: since the last call of `pop_outgoing` something was sent that may be waited for
        self.answered = False
        self._outgoing: Parcels = []
        self._outgoing_bytes = 0
        self._unread_bytes = 0  # at most: what was read since is not subtracted
        self.theirs: tuple[EndpointInfo, ...] = ()
        #: what hidden readers have received
        self._heard: list[tuple[str, str, int, bytes, int]] = []
        self.published: dict[str, str] = {}

    # What the student's side reads and publishes ----------------------------------------------

    def note(self, table: Table, member: int = 1) -> None:
        """Note what a program reads and publishes now."""
        numbers = [*(each.id for each in table.added), *table.removed]
        if any(number >> SHIFT != member for number in numbers):
            raise ValueError("numbers of another process")
        if len(self.others) + len(table.added) > MOST_ENDPOINTS:
            raise ValueError("too many endpoints")
        self.add_others(table)
        self.remove_others(table.removed)
        self.pair()
        shown = (each for each in self.others.values() if not isinstance(each, NodeEntry))
        entries = (each.info() for each in shown)
        self.theirs = tuple(
            sorted(
                e._replace(type=e.type.rstrip(), id=e.id >> SHIFT, is_hidden=False) for e in entries
            )
        )
        types: dict[str, set[str]] = {}
        for each in self.theirs:
            kind, _, topic = each.channel.partition(" ")
            if each.writes and kind == "topic":
                types.setdefault(topic, set()).add(each.type)
        for endpoint in (*self.writers, *self.readers):
            if endpoint.name in types and endpoint.kind == "topic":
                types[endpoint.name].add(endpoint.type)
        # as the graph shows it: of several types on a topic, ours too, the first
        for topic, kinds in types.items():
            if topic in self.published or len(self.published) < MOST_TOPICS:
                self.published[topic] = min(kinds)
            else:
                self._flag(
                    msg("the node published on more than {number} topics", number=MOST_TOPICS)
                )

    def others_are_read(self, writers: Iterable[Writer]) -> bool:
        """Whether the student's side reads a topic of ours that is not one of these."""
        known = {writer.channel for writer in writers}
        return any(
            writer.is_stream and writer.remote and writer.channel not in known
            for writer in self.writers
        )

    def tap(self, topic: str, kind: str, message: Any) -> None:
        """Record what the student's side publishes on a topic, by a reader that no graph shows.

        DDS has one type a topic in each process, and so has no such reader.

        Args:
            kind: a type that it publishes there, whose class is `message`.
        """
        qos = QoSProfile(
            history=QoSHistoryPolicy.KEEP_ALL, reliability=QoSReliabilityPolicy.BEST_EFFORT
        )
        reader = Reader(f"topic {topic}", kind, qos, message=message, is_hidden=True)
        self.add(reader)

    def pop_heard(self) -> list[tuple[str, str, int, bytes, int]]:
        """Return what hidden readers have received since the last call, in the order of sending.

        Topic, type, when it was sent [ns from the start], CDR, the sender's number.
        """
        heard, self._heard = self._heard, []
        return heard

    # Messages ---------------------------------------------------------------------------------

    def send_to_others(self, writer: Writer, data: bytes) -> None:
        """Send a topic's message once to all programs that hear the writer."""
        if writer.remote or writer.is_lasting:
            self.send(writer.number, 0, writer.sent, data)

    def send_parcel(self, parcel: Parcel) -> None:
        """Have a message sent with the next reply."""
        self._outgoing.append(parcel)
        self._outgoing_bytes += len(parcel.data)
        writer = self.own.get(parcel.endpoint)
        is_answer = not (isinstance(writer, Writer) and writer.is_stream)
        # more than a few pictures are sent as soon as an answer would be
        self.answered = self.answered or is_answer or self._outgoing_bytes > MOST_OUTGOING

    def pop_outgoing(self) -> Parcels:
        """Return what was sent to the student's side since the last call."""
        parcels, self._outgoing = self._outgoing, []
        self._outgoing_bytes = 0
        self.answered = False
        return parcels

    def receive(self, parcels: Parcels, member: int, since_ns: int, until_ns: int) -> None:
        """Put what a program has sent in its turn into the readers.

        Args:
            member: its number.
            since_ns, until_ns: of the turn, from the start of the run; the messages say themselves
                when in it they were sent.
        """
        for endpoint, client, number, time_ns, data in parcels:
            reader = self.own.get(endpoint)
            if not isinstance(reader, Reader):
                continue  # gone meanwhile
            if not self._has_room(len(data)):
                self._flag(_TOO_MUCH.given(channel=reader.channel))
                continue
            try:
                deserialized(data, reader.message)
            except Exception:  # of rclpy's C++
                self._flag(msg("a message on {channel} could not be read", channel=reader.channel))
                continue
            if reader.is_hidden:
                sent_ns = min(max(since_ns, time_ns), until_ns)
                self._heard.append((reader.name, reader.type, sent_ns, data, member))
                continue
            asked_by = client if reader.kind == "request" else None
            reader.items.append(Arrived(data, self.now_ns(), number, asked_by))

    def _has_room(self, length: int) -> bool:
        """Whether a message of this length fits beside what is not yet read."""
        if length <= LARGE:
            return True
        if length > LONGEST_MESSAGE:
            return False
        if self._unread_bytes + length > MOST_UNREAD:
            waiting = (len(item.data) for reader in self.readers for item in reader.items)
            self._unread_bytes = sum(waiting)
        if self._unread_bytes + length > MOST_UNREAD:
            return False
        self._unread_bytes += length
        return True

    def has_unread(self) -> bool:
        """Whether something waits to be served."""
        return any(reader.items for reader in self.readers)
