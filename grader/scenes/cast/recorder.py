"""Keeps what the program and the peers exchange, and its types; in the simulator's process.

| event | its values |
|---|---|
| offers | node, what, name, type: an endpoint of a peer's |
| endpoint | node, channel, type, writes, reliability, durability, depth: one of the program's |
| call | peer, id, service, type, request, sent_ns; response, answered_ns |
| served | peer, service, type, request; response, answered_ns |
| goal | peer, id, action, type, goal, sent_ns; accepted, feedback, status, result, ended_ns |
| action | peer, action, type, goal, accepted; feedback, status, ended_ns |
| parameter | peer, id, node, sent_ns; set {name: reason or ''}, values {name: value}, answered_ns |
| got | peer, topic, values: what a subscription has received |
| refused | peer, what, why: what a peer could not do with what the program sent |
| unsaid | peer, what, why: what a peer was to say, and no message can hold |
| full | nothing: what came then is not recorded |
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import Any, Final

from grader.ros.definitions import Definitions, is_installed, slot_of
from grader.ros.messages import deserialise, members, plain, serialise, value_type
from grader.scenes.cast.trace import EVENTS, OBLIGATORY, ROSOUT, CastTrace, Event, SentMessage
from grader.text.message import Message, msg

#: The most messages, bytes of them and of what is in events, and events of a recording.
MOST_MESSAGES, MOST_BYTES, MOST_EVENTS = 20_000, 20_000_000, 10_000
_FULL: Final = msg("of what was exchanged, the first {n:,} messages and {m:,} bytes were recorded")


class CastRecorder:
    """A recording in the making.

    Args:
        topics: names of those that are heard besides `/rosout`, with their namespaces.
        peers: the names of the cast's nodes, with theirs.
        now_ns: the time from the start of the run [ns].
        tap: called with a topic, a type and its class: has that be heard from now on.
    """

    def __init__(
        self,
        types: Types,
        topics: Iterable[str],
        peers: Iterable[str],
        now_ns: Callable[[], int],
        tap: Callable[[str, str, Any], None],
    ) -> None:
        self._types = types
        self._topics = {*topics, ROSOUT} - {EVENTS}
        self._peers = frozenset(peers)
        self._now_ns = now_ns
        self._tap = tap
        #: a bag has one type a topic: that of the first message
        self._types_of: dict[str, str] = {}
        self._tapped: set[tuple[str, str]] = set()
        #: topic -> nodes, each with the number of its program; and the other way round
        self._writers: dict[str, set[tuple[str, int]]] = {}
        self._programs: dict[str, set[int]] = {}
        self._endpoints: set[tuple[Any, ...]] = set()
        self._messages: list[SentMessage] = []
        self._events: list[dict[str, Any]] = []
        self._bytes = 0
        self.flags: list[Message] = []

    @property
    def is_full(self) -> bool:
        return bool(self.flags)

    def meet(self, endpoints: Iterable[Any]) -> None:
        """Note the program's readers and writers, and hear those that are asked for.

        Args:
            endpoints: `grader.run.lockstep.protocol.EndpointInfo`s, as numbers those of programs.
        """
        self._writers = {}
        for each in endpoints:
            kind, _, name = each.channel.partition(" ")
            if each not in self._endpoints and len(self._endpoints) <= MOST_EVENTS:
                self._endpoints.add(each)
                self.event("endpoint", **dict(zip(OBLIGATORY["endpoint"], each, strict=False)))
                self._programs.setdefault(each.node, set()).add(each.id)
            if kind == "topic" and each.writes:
                self._writers.setdefault(name, set()).add((each.node, each.id))
                if name in self._topics and (name, each.type) not in self._tapped:
                    self._tapped.add((name, each.type))
                    try:
                        self._tap(name, each.type, self._types.use(each.type))
                    except NoType:  # one of its own that nobody has
                        continue

    def event(self, kind: str, **values: Any) -> dict[str, Any]:
        """Add an event, whose values may still be completed."""
        made = {"kind": kind, "time_ns": self._now_ns(), **values}
        if len(self._events) < MOST_EVENTS:
            self._events.append(made)
        else:
            self._note_full()
        return made

    def plain(self, message: Any) -> dict[str, Any]:
        """Return the values of a message for an event; none where there is no room for them."""
        return plain(message) if self._has_room(len(serialise(message))) else {}

    def heard(self, topic: str, kind: str, time_ns: int, data: bytes, program: int = 0) -> None:
        """Add a message, in CDR, of the program with a number; 0: nobody knows of which."""
        if not self._is_of_type(topic, kind) or not self._has_room(len(data), 1):
            return
        try:
            canonical = serialise(deserialise(data, self._types.use(kind)))
        except ValueError:
            return
        writers = self._writers.get(topic, set())
        nodes = {node for node, number in writers if number == program}
        nodes -= self._peers  # it may call itself like one
        node = min(nodes) if len(nodes) == 1 else ""
        self._messages.append(SentMessage(time_ns, topic, kind, node, canonical))

    def said(self, topic: str, kind: str, node: str, message: Any) -> None:
        self._types.use(kind)
        data = serialise(message)
        if self._is_of_type(topic, kind) and self._has_room(len(data), 1):
            self._messages.append(SentMessage(self._now_ns(), topic, kind, node, data))

    def _is_of_type(self, topic: str, kind: str) -> bool:
        return self._types_of.setdefault(topic, kind) == kind

    def _has_room(self, size: int, messages: int = 0) -> bool:
        """Whether there is room for so many bytes and messages; it is used then."""
        if self._bytes + size > MOST_BYTES or len(self._messages) + messages > MOST_MESSAGES:
            self._note_full()
        if self.is_full:
            return False
        self._bytes += size
        return True

    def _note_full(self) -> None:
        if not self.is_full:
            self.flags.append(_FULL.given(n=MOST_MESSAGES, m=MOST_BYTES))
            self._events.append({"kind": "full", "time_ns": self._now_ns()})

    def trace(
        self, ticks: int, peers: Iterable[str], names: Mapping[int, str] = MappingProxyType({})
    ) -> CastTrace:
        """Return the recording up to now; of several programs, with these names."""
        events: tuple[Event, ...] = tuple(map(dict, self._events))
        messages = tuple(sorted(self._messages, key=lambda each: each.time_ns))
        programs = {
            node: ", ".join(names[number] for number in sorted(numbers & names.keys()))
            for node, numbers in self._programs.items()
            if names
        }
        return CastTrace(ticks, messages, events, tuple(peers), dict(self._types.used), programs)


# The classes of types that a cast speaks, and their definitions -----------------------------------

#: Basic types, where a definition has other names.
_BASIC: Final = {"boolean": "bool", "octet": "uint8", "float": "float32", "double": "float64"}


class NoType(LookupError):
    """There is no type of this name here."""


class Types:
    """The classes of types: those of an exercise and a hand-in, else installed ones.

    Args:
        texts: the definitions of the former, by names such as 'my_interfaces/msg/Num'.
        are_compiled: whether these can be imported as installed ones can.
    """

    def __init__(self, texts: Mapping[str, str], *, are_compiled: bool = False) -> None:
        self._texts = texts
        self._own = Definitions({} if are_compiled else texts)
        #: definitions of all messages that were asked for, and of their fields
        self.used: dict[str, str] = {}

    def find(self, name: str) -> Any:
        """Return the class of a type.

        Raises:
            NoType: there is none.
        """
        try:
            if name not in self._texts and not is_installed(slot_of(name)):
                raise ImportError(name)  # else any module would be imported
            return self._own.type(name)
        except (ImportError, AttributeError) as error:
            raise NoType(f"there is no type {name}: {error}") from None

    def use(self, name: str) -> Any:
        """Return the class of a message, whose definition a recording is to have.

        Raises:
            NoType: there is none.
        """
        if name.split("/")[1] != "msg":  # a service's, on a topic
            raise NoType(f"{name} is no message")
        found = self.find(name)
        if name not in self.used:
            inner = [value_type(slot) for _, slot in members(found)]
            text = "".join(f"{_written(slot)} {field}\n" for field, slot in members(found))
            for each in inner:
                if hasattr(each, "namespaces"):
                    self.use("/".join((*each.namespaces, each.name)))
            self.used[name] = text
        return found


def _written(slot: Any) -> str:
    """Return a field's type as readers of bags know it, which have no bounds and no wstring."""
    inner = value_type(slot)
    if hasattr(inner, "namespaces"):
        base = f"{inner.namespaces[0]}/{inner.name}"
    elif hasattr(inner, "typename"):
        base = _BASIC.get(inner.typename, inner.typename)
    elif "WString" not in type(inner).__name__:
        base = "string"
    elif inner is slot:
        return "uint32[]"  # as it is in CDR
    else:
        raise NoType("no reader of bags knows lists of wstring")
    return base if inner is slot else f"{base}[{getattr(slot, 'size', '')}]"
