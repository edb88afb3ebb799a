"""The simulator's readers and writers, as the submission's process knows them from its tables."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

from grader.run.lockstep.registry import Arrived, Endpoint, Reader


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
