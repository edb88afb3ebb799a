"""A cast in a run: its peers act and are served in each tick, its recorder keeps what is said."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any, Protocol

from grader.scenes.cast.peers import PeerNode
from grader.scenes.cast.recorder import CastRecorder, Types
from grader.scenes.cast.script import Peer, endpoints, heard
from grader.scenes.cast.trace import CastTrace
from grader.scenes.scene import STEP_NS
from grader.text.message import Message


class Wire(Protocol):
    """What a clock offers a cast: which endpoints the program has, and what it sends.

    Attributes:
        now_ns: the time from the start of the run [ns].
        names: of the programs, by their numbers, where there are several and that is known.
    """

    def tap(self, topic: str, kind: str, message: Any) -> None:
        """Record what the program publishes on a topic with a type, whose class is `message`."""

    def heard(self) -> Iterable[tuple[str, str, int, bytes, int]]:
        """Return what was recorded since.

        Topic, type, when [ns from the start], CDR, and the sender's number; 0: nobody knows.
        """

    def has_unread(self, node: str) -> bool:
        """Whether something waits for a peer's node."""

    now_ns: int
    names: Mapping[int, str]


class Playing:
    """A cast at work.

    Args:
        peers: what its nodes do, by their names.
        topics: those that are recorded besides what the peers hear.
        definitions: of types that are not installed, or were compiled for this run.
        end_s: how long the run may last [s].
    """

    def __init__(
        self,
        peers: Mapping[str, Peer],
        topics: Iterable[str],
        definitions: Mapping[str, str],
        end_s: float,
        wire: Wire,
        *,
        are_compiled: bool = False,
    ) -> None:
        self._wire = wire
        #: of the program's channels; of the first endpoint where several differ
        self._types_of: dict[str, str] = {}
        types = Types(definitions, are_compiled=are_compiled)

        def now_ns() -> int:
            return wire.now_ns

        names = [f"/{name}" for name in peers]
        self._recorder = CastRecorder(types, heard(peers, topics), names, now_ns, wire.tap)
        for each in endpoints(peers):
            facts = {"node": each.node, "what": each.kind, "name": each.name, "type": each.type}
            self._recorder.event("offers", **facts)
        more = (types, self._recorder, end_s, now_ns, self._type_of)
        self._peers = [PeerNode(name, peer, *more) for name, peer in peers.items()]

    @property
    def nodes(self) -> tuple[Any, ...]:
        return tuple(peer.node for peer in self._peers)

    @property
    def has_met(self) -> bool:
        return bool(self._types_of)

    @property
    def flags(self) -> tuple[Message, ...]:
        return tuple(self._recorder.flags)

    def meet(self, endpoints: tuple[Any, ...]) -> None:
        """Note which endpoints the program has now."""
        self._types_of = {each.channel: each.type for each in reversed(endpoints)}
        self._recorder.meet(endpoints)

    def record(self) -> None:
        for message in self._wire.heard():
            self._recorder.heard(*message)

    def act(self) -> None:
        """Let the peers be served, and do what is due, in a tick."""
        self.record()
        for peer in self._peers:
            if self._wire.has_unread(peer.name):
                peer.serve(self._wire.has_unread)
        for peer in self._peers:
            if peer.act():
                peer.serve(self._wire.has_unread)

    def quiet_ticks(self) -> int:
        """Return for how many ticks no peer will do anything by itself."""
        first_ns = min((peer.next_ns for peer in self._peers), default=1 << 62)
        return max(0, math.ceil((first_ns - self._wire.now_ns) / STEP_NS) - 1)

    def trace(self, ticks: int) -> CastTrace:
        self.record()
        names = self._wire.names
        return self._recorder.trace(ticks, (peer.name for peer in self._peers), names)

    def _type_of(self, kind: str, name: str) -> str:
        return self._types_of.get(f"{kind} {name}", "")
