"""The simulator's readers and writers, as the submission's process knows them from its tables.

Who hears whom follows from names, types and quality of service.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from grader.run.lockstep.protocol import Table
from grader.run.lockstep.registry import (
    Arrived,
    Endpoint,
    Reader,
    Writer,
    compatible,
    policies,
    suits,
)


@dataclass(eq=False)
class RemoteEndpoint(Endpoint):
    """A reader or writer of the simulator.

    Attributes:
        id: as in the tables.
        writes: which of the two it is.
        readers: ours that it writes to.
        history: what late readers get, if it is lasting.
    """

    id: int = 0
    writes: bool = False
    readers: list[Reader] = field(default_factory=list)
    history: deque[Arrived] = field(default_factory=deque)

    def __post_init__(self) -> None:
        self.history = deque(maxlen=self.qos.depth)


class Remotes:
    """All of them, and who of this process is connected with which.

    Attributes:
        by_number: number -> endpoint.
    """

    def __init__(self) -> None:
        self.by_number: dict[int, RemoteEndpoint] = {}
        self._met: set[tuple[Endpoint, Endpoint]] = set()

    def add(self, table: Table) -> None:
        """These are new."""
        for entry in table.added:
            qos = policies(entry.reliability, entry.durability, entry.depth)
            self.by_number[entry.id] = RemoteEndpoint(
                entry.channel, entry.type, qos, id=entry.id, writes=entry.writes
            )

    def remove(self, table: Table) -> None:
        """These are gone."""
        for number in table.removed:
            self.by_number.pop(number, None)

    def pair(self, writers: Sequence[Writer], readers: Sequence[Reader]) -> None:
        """Connect them with the endpoints of this process; late readers get what is kept."""
        remotes: dict[str, list[RemoteEndpoint]] = defaultdict(list)
        for remote in self.by_number.values():
            remotes[remote.channel].append(remote)
            remote.readers = []
        for reader in readers:
            before, reader.remote = reader.remote, []
            for remote in remotes[reader.channel]:
                if remote.writes and compatible(remote, reader):
                    reader.remote.append(remote)
                    remote.readers.append(reader)
                    if remote not in before and remote.is_lasting and reader.is_lasting:
                        reader.items.extend(remote.history)
            reader.hears = bool(reader.remote) and reader.kind == "topic"
        for writer in writers:
            hearing = [remote for remote in remotes[writer.channel] if not remote.writes]
            writer.remote = [remote for remote in hearing if compatible(writer, remote)]
        self._count_meetings(writers, readers)

    def _count_meetings(self, writers: Sequence[Writer], readers: Sequence[Reader]) -> None:
        """Count which endpoints of a topic meet, and have met for the first time."""
        for endpoint in (*writers, *readers):
            endpoint.matched = 0
        remotes = self.by_number.values()
        hearing: dict[str, list[Endpoint]] = defaultdict(list)
        for reader in (*readers, *(remote for remote in remotes if not remote.writes)):
            hearing[reader.channel].append(reader)
        for writer in (*writers, *(remote for remote in remotes if remote.writes)):
            self._count_of(writer, hearing)

    def _count_of(self, writer: Endpoint, hearing: Mapping[str, Sequence[Endpoint]]) -> None:
        for reader in hearing.get(writer.channel, ()):
            if writer.type != reader.type:
                continue
            is_new = (writer, reader) not in self._met
            self._met.add((writer, reader))
            fits = suits(writer, reader)
            for endpoint in (writer, reader):
                endpoint.matched += fits
                endpoint.matches += fits and is_new
                endpoint.unfit += is_new and not fits
