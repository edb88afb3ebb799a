"""The protocol between a submission's process and the simulator: packets, encoded as bytes.

The student's process drives, over a SOCK_SEQPACKET socket pair:

| from | packet | meaning |
|---|---|---|
| both | `Table` | these endpoints are new, these are gone; the simulator begins with one |
| student | `Advance` | let time move, to this deadline or until something comes |
| simulator | `Reply` | so late it is; here are messages, some of ticks to come |
| student | `Note` | something about the student's process; not answered |

With the first table the simulator sends the end of a second socket pair, on which `Mail` goes to
the simulator. The student's side writes the tick that it has reached at the start of a page that
both have from the grader (`PROGRESS`). The simulator reads both when it is asked to advance, and
when the student's process ends or stalls silently: what was sent before counts.

Messages travel here and not by DDS, in the bytes that DDS would have carried (CDR): DDS delivers
when it likes, and a message that it has delivered late would change the run.

Everything that comes from the student's process is untrusted: `decode` checks its form, and the
simulator checks the numbers. It can distort its own pace, nothing else.
"""

from __future__ import annotations

import json
import mmap
import re
import socket
from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import IntEnum
from struct import Struct
from typing import Any, NamedTuple

from grader.text.message import NOTHING, Message

#: A tick's length [ns]. As in turtlesim_py.world.arena, whose import would cost a student's
#: process numpy and Pillow.
TICK_NS = 16_000_000
#: The run starts on 15 June 2025 at 15:06:40 UTC, 1000 s after the machine did.
EPOCH_NS = 1_750_000_000 * 10**9
BOOT_NS = 1000 * 10**9
#: No deadline [ns since the start of the run].
NEVER = 1 << 62
#: The number of an endpoint's process stands above so many bits of its own.
SHIFT = 20

#: The most that is sent at once: a socket accepts no longer packet as a whole.
PIECE_BYTES = 150_000
#: The longest packet from the simulator: a picture of the window takes 0.75 MB, and some may come
#: at once.
LIMIT_BYTES = 64_000_000
#: Before each piece of a longer packet, and before its last one.
MORE, LAST = b"+", b"-"

#: The tick that the student's side has reached, at the start of a page that both see: it is known
#: there when that side ends silently. Its part of the page is the least that can be mapped.
PROGRESS, PROGRESS_BYTES = Struct("<Q"), mmap.PAGESIZE

_HEAD = Struct("<cQIQQ?")
_PARCEL = Struct("<IIQQI")
_CHANNEL = re.compile(r"[a-z]+ /[\w/]{0,600}", re.ASCII)
_NAME = re.compile(r"/[\w/]{0,600}", re.ASCII)
_TYPE = re.compile(r"\w{1,100}/\w{1,10}/\w{1,200} ?", re.ASCII)
#: The most that is kept of each text of a remark [characters].
_LONGEST_REMARK = 1000


class ProtocolError(Exception):
    """A packet that neither side of ours sends."""


#: The most messages, requests and responses that a submission may send in a run, heard or not: five
#: a millisecond for 20 s; and their bytes. Its process counts them, and is believed: other limits
#: hold besides.
MOST_SENT, MOST_SENT_BYTES = 100_000, 2_000_000_000


class Kind(IntEnum):
    """What a `Note` is about."""

    STUCK = 1  # its threads wait for something that can no longer happen, in a callback
    WAITING = 2  # its threads wait for something that will not come, as a program may at its end
    UNSUPPORTED = 3  # it did what virtual time cannot follow, named in `remark`
    FAILED = 4  # virtual time does not work here; `remark` is the reason, as a clause
    FLOODING = 5  # it has sent more than `MOST_SENT`, or `MOST_SENT_BYTES`


class Parcel(NamedTuple):
    """A message on the link.

    Attributes:
        endpoint: the number, in the tables, of the reader that gets it; of the simulator's
            messages on a topic, that of its writer.
        client: of a request, the number of the reader for its response; else 0.
        number: the sequence number of the request; on a topic, of the message.
        time_ns: when it was sent, from the start of the run [ns]; from the simulator, in a tick.
        data: the message in CDR, as DDS would carry it.
    """

    endpoint: int
    client: int
    number: int
    time_ns: int
    data: bytes


Parcels = list[Parcel]


class EndpointInfo(NamedTuple):
    """A node, reader or writer of a process, as others need to know it.

    Attributes:
        node: the name of its node, with the namespace.
        channel: what it is connected to; of a node, "node /name".
        type: the ROS type; '' for a node. One that ends with a space is not the other side's type
            of that name, and meets no other.
        id: its number on the link: that of its process above `SHIFT`, 0 for the simulator.
        is_hidden: it only records, and the program's graph does not show it.
    """

    node: str
    channel: str
    type: str
    writes: bool
    reliability: int = 1
    durability: int = 2
    depth: int = 10
    id: int = 0
    is_hidden: bool = False


@dataclass(frozen=True)
class Table:
    """What appeared and disappeared in a process since its last table.

    A removed one may still have sent something that comes with the next `Reply`.

    Attributes:
        now_ns: of the first one to a program: when that begins.
    """

    added: tuple[EndpointInfo, ...]
    removed: tuple[int, ...] = ()
    now_ns: int = 0


@dataclass(frozen=True)
class Advance:
    """Let time move.

    Attributes:
        target_ns: the program's next deadline; 0 for a reply at once.
        listens: whether it waits for messages besides.
        reached: the tick up to which the student's side has used what was foreseen.
        now_ns: the time that it has reached by itself.
        has_mailed: whether mail was sent since the last one.
    """

    target_ns: int
    listens: bool
    reached: int
    now_ns: int
    has_mailed: bool = False


@dataclass(frozen=True)
class Reply:
    """Where the run stands.

    Attributes:
        now_ns: the time.
        is_over: whether the run is.
        foreseen: the tick up to which the messages are those that will be sent, if the student's
            side sends nothing meanwhile.
        until_ns: the program may let time move by itself before this.
        parcels: by tick.
    """

    now_ns: int
    is_over: bool
    foreseen: int
    until_ns: int = NEVER
    parcels: Parcels = field(default_factory=list)


@dataclass(frozen=True)
class Mail:
    """Messages from the student's process, sent when the program sent them."""

    parcels: Parcels


@dataclass(frozen=True)
class Note:
    """A fact about the student's process, with a remark on it."""

    kind: Kind
    remark: Message = NOTHING


Packet = Table | Advance | Reply | Mail | Note


def encode(packet: Packet) -> bytes:
    match packet:
        case Advance(target_ns, listens, reached, now_ns, has_mailed):
            return _HEAD.pack(b"A", target_ns, listens, reached, now_ns, has_mailed)
        case Reply(now_ns, is_over, foreseen, until_ns, parcels):
            return _HEAD.pack(b"R", now_ns, is_over, foreseen, until_ns, False) + _parcels(parcels)
        case Mail(parcels):
            return _HEAD.pack(b"M", 0, 0, 0, 0, False) + _parcels(parcels)
        case Note(kind, remark):
            return _HEAD.pack(b"N", 0, kind, 0, 0, False) + json.dumps(remark.serialise()).encode()
        case Table(added, removed, now_ns):
            return b"T" + json.dumps([added, removed, now_ns]).encode()


def decode(data: bytes) -> Packet:
    """Decode a packet.

    Raises:
        ProtocolError: the bytes are no packet.
    """
    try:
        if data[:1] == b"T":
            return _table(*json.loads(data[1:]))
        name, number, other, further, last, flag = _HEAD.unpack_from(data)
        match name:
            case b"N":
                return Note(Kind(other), Message.parse(json.loads(data[_HEAD.size :]), _remarked))
            case b"A":
                return Advance(number, bool(other), further, last, flag)
            case b"R":
                return Reply(number, bool(other), further, last, _read_parcels(data))
            case b"M":
                return Mail(_read_parcels(data))
    except Exception as error:
        raise ProtocolError(f"{data[:32]!r}: {error!r}") from None
    raise ProtocolError(f"{data[:32]!r}: no such packet")


def _remarked(text: object) -> str:
    if not isinstance(text, str):
        raise ValueError(f"no part of a remark: {text!r:.100}")
    from grader.text.strings import (
        without_controls,  # here: a submission's process has it not in reach
    )

    return without_controls(text[:_LONGEST_REMARK], "?")


def _parcels(parcels: Parcels) -> bytes:
    pack = _PARCEL.pack
    return b"".join(
        [
            pack(endpoint, client, number, time_ns, len(data)) + data
            for endpoint, client, number, time_ns, data in parcels
        ]
    )


def _read_parcels(data: bytes) -> Parcels:
    found = []
    at, end, size, unpack = _HEAD.size, len(data), _PARCEL.size, _PARCEL.unpack_from
    while at < end:
        endpoint, client, number, time_ns, length = unpack(data, at)
        at += size
        if at + length > end:
            raise ValueError("cut off")
        found.append(Parcel(endpoint, client, number, time_ns, data[at : at + length]))
        at += length
    return found


def _table(added: Any, removed: Any, now_ns: Any = 0) -> Table:
    endpoints = tuple(EndpointInfo(*values) for values in added)
    for each in endpoints:
        forms = [(_NAME, each.node), (_CHANNEL, each.channel)]
        forms += [] if each.channel.startswith("node ") else [(_TYPE, each.type)]
        if not all(form.fullmatch(text) for form, text in forms):
            raise ValueError(f"no endpoint: {each!r:.200}")
        if not type(each.writes) is type(each.is_hidden) is bool:
            raise ValueError(f"no endpoint: {each!r:.200}")
        _must_be_numbers(each[4:8])
    _must_be_numbers(removed)
    return Table(endpoints, tuple(removed), int(now_ns))


def _must_be_numbers(values: Any) -> None:
    if not all(type(number) is int and 0 <= number < 1 << 32 for number in values):
        raise ValueError(f"no numbers of an endpoint: {values!r:.200}")


# Packets of any length over a socket ---------------------------------------------------------


def pieces(data: bytes) -> Iterator[bytes]:
    """Split a packet into the pieces that are sent one by one, for a `PacketReader`."""
    if len(data) <= PIECE_BYTES:
        yield data
        return
    for begin in range(0, len(data), PIECE_BYTES):
        end = begin + PIECE_BYTES
        yield (LAST if end >= len(data) else MORE) + data[begin:end]


class PacketReader:
    """Reads packets from a socket, and joins the pieces of long ones."""

    def __init__(self, link: socket.socket, limit_bytes: int = LIMIT_BYTES) -> None:
        self._link = link
        self._limit_bytes = limit_bytes
        self._pieces: list[bytes] = []
        self._length = 0

    def read(self) -> bytes | None:
        """Receive once: a packet, b"" when the other side has gone, None for part of a packet.

        Raises:
            OSError: the other side has gone.
            ProtocolError: it is longer than any of ours, or in pieces that are none of ours.
        """
        data = self._link.recv(PIECE_BYTES + 1)
        if data[:1] not in (MORE, LAST):
            if self._pieces and data:
                raise ProtocolError(f"{data[:32]!r} in the middle of a packet")
            return data
        is_last = data[:1] == LAST
        if not is_last and len(data) != PIECE_BYTES + 1:  # many small ones would fill memory too
            raise ProtocolError(f"a piece of {len(data)} bytes")
        self._pieces.append(data[1:])
        self._length += len(data)
        if self._length > self._limit_bytes:
            raise ProtocolError(f"a packet of more than {self._limit_bytes} bytes")
        if not is_last:
            return None
        whole = b"".join(self._pieces)
        self._pieces, self._length = [], 0
        return whole
