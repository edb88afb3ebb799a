"""The simulator's readers and writers, as the submission's process knows them from its tables."""

from __future__ import annotations

from dataclasses import dataclass, field

from rclpy.qos import QoSDurabilityPolicy

from grader.run.lockstep.registry import Endpoint, Reader


@dataclass(eq=False)
class RemoteEndpoint(Endpoint):
    """A reader or writer of the simulator.

    Attributes:
        id: as in the tables.
        writes: which of the two it is.
        sent: how much we have sent to it; it has sent so much.
        readers: ours that it writes to.
    """

    id: int = 0
    writes: bool = False
    sent: int = 0
    readers: list[Reader] = field(default_factory=list)


def remembers(writer: Endpoint, reader: Endpoint) -> bool:
    """Whether a new reader still gets the writer's last message."""
    lasting = QoSDurabilityPolicy.TRANSIENT_LOCAL
    return bool(writer.qos.durability == lasting and reader.qos.durability == lasting)
