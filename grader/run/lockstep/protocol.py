"""The link between a submission's process and the simulator: what each side says, as bytes.

One packet a message, over a SOCK_SEQPACKET socket pair. The student's process drives:

| from | packet | meaning |
|---|---|---|
| simulator | `Table` | these endpoints of mine are new, these are gone; first of all packets |
| student | `Hello` | so many of my endpoints match each of yours; `Hello` answers when both agree |
| student | `Advance` | I have sent so many messages; run until this tick, at most so many ticks |
| simulator | `Reply` | this tick is over; I have sent so many messages |
| student | `Note` | something about the student's process; not answered |

Everything that comes from the student's process is untrusted: `decode` checks its form, and the
simulator checks the numbers. It can distort its own pace, nothing else.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from enum import IntEnum
from struct import Struct
from typing import Any

#: A tick's length [ns]. As in turtlesim_py.world.arena, whose import would cost a student's
#: process numpy and Pillow.
TICK_NS = 16_000_000
#: More ticks than any run has; "until something happens".
FOREVER = 1 << 40
#: The longest packet.
LIMIT_BYTES = 200_000

_HEAD = Struct("<cQI")
_COUNT = Struct("<IQ")


class ProtocolError(Exception):
    """A packet that neither side of ours sends."""


class State(IntEnum):
    """What a `Reply` says about the run."""

    RUNNING = 0
    CHANGED = 1  # the simulator's endpoints; a `Table` follows, and the tick waits for a `Hello`
    OVER = 2


class Kind(IntEnum):
    """What a `Note` is about."""

    LEAVING = 0  # the student's program has ended, everything sent has been announced
    STUCK = 1  # its threads wait for something that can no longer happen, in a callback
    WAITING = 2  # its threads wait for something that will not come, as a program may at its end
    UNSUPPORTED = 3  # it did what virtual time cannot follow: `text` says what
    WARNING = 4  # DDS did not deliver or match in time; `text` says what
    FAILED = 5  # virtual time does not work here; `text` says why, as a clause


Counts = list[tuple[int, int]]  # (id of a simulator's endpoint, number)


@dataclass(frozen=True)
class EndpointInfo:
    """A reader or writer of the simulator, as the student's side needs to know it."""

    id: int
    channel: str
    type: str
    writes: bool
    reliability: int
    durability: int


@dataclass(frozen=True)
class Table:
    """Endpoints that appeared and disappeared since the last table."""

    added: tuple[EndpointInfo, ...]
    removed: tuple[int, ...] = ()


@dataclass(frozen=True)
class Hello:
    """How many endpoints of the student match each of the simulator's (absent: none).

    `publishers`: how many it has in all; some publish where nobody listens.
    """

    matched: Counts
    publishers: int = 0


@dataclass(frozen=True)
class Advance:
    """Run until `target`, but not more than `most` ticks; `sent`: totals, where they changed."""

    target: int
    most: int
    sent: Counts


@dataclass(frozen=True)
class Reply:
    """Where the simulator stands; `sent`: totals, where they changed."""

    tick: int
    state: State
    sent: Counts


@dataclass(frozen=True)
class Note:
    """Something about the student's process."""

    kind: Kind
    text: str = ""


Packet = Table | Hello | Advance | Reply | Note


def encode(packet: Packet) -> bytes:
    """A packet's bytes."""
    match packet:
        case Advance(target, most, sent):
            return _encode(b"A", target, most, sent)
        case Reply(tick, state, sent):
            return _encode(b"R", tick, state, sent)
        case Hello(matched, publishers):
            return _encode(b"H", publishers, 0, matched)
        case Note(kind, text):
            return _HEAD.pack(b"N", 0, kind) + text.encode("utf-8", "replace")[:1000]
        case Table(added, removed):
            data = {"added": [vars(endpoint) for endpoint in added], "removed": removed}
            return b"T" + json.dumps(data).encode()


def decode(data: bytes) -> Packet:
    """The packet that bytes mean.

    Raises:
        ProtocolError: they mean none.
    """
    try:
        if data[:1] == b"T":
            return _table(json.loads(data[1:]))
        name, number, other = _HEAD.unpack_from(data)
        if name == b"N":
            return Note(Kind(other), data[_HEAD.size :].decode("utf-8", "replace"))
        counts: Counts = list(_COUNT.iter_unpack(data[_HEAD.size :]))
        if name == b"A":
            return Advance(number, other, counts)
        if name == b"R":
            return Reply(number, State(other), counts)
        if name == b"H":
            return Hello(counts, number)
    except Exception as error:
        raise ProtocolError(f"{data[:32]!r}: {error!r}") from None
    raise ProtocolError(f"{data[:32]!r}: no such packet")


def _encode(name: bytes, number: int, other: int, counts: Counts) -> bytes:
    head = _HEAD.pack(name, number, other)
    return head + b"".join([_COUNT.pack(*count) for count in counts]) if counts else head


def _table(data: dict[str, Any]) -> Table:
    return Table(tuple(EndpointInfo(**entry) for entry in data["added"]), tuple(data["removed"]))
