"""Writes an MCAP file with a profile of ROS 2, as rosbag2 does, and reads it: https://mcap.dev/spec.

The library rosbags writes the same, byte for byte but for its name in the header
(tests/grader/recording/test_bag.py), and Foxglove's mcap reads it; both go message by message,
which takes several times as long.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from struct import Struct, error, pack, unpack_from
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from grader.recording import zstd

#: Who wrote a file; without a version, since equal runs are equal files.
LIBRARY: Final = "turtlesim-py"
MAGIC: Final = b"\x89MCAP0\r\n"
(HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX) = range(1, 9)
STATISTICS, METADATA, METADATA_INDEX, SUMMARY_OFFSET, DATA_END = 0x0B, 0x0C, 0x0D, 0x0E, 0x0F
#: A chunk is closed when it is longer [bytes].
CHUNK_BYTES: Final = 1 << 20
#: The most that is read of a file [bytes]: nobody knows before how much it decompresses to.
MOST_BYTES: Final = 1 << 30
#: Up to its data: opcode, length; channel, sequence, time of the log and of the publication [ns].
_MESSAGE: Final = Struct("<BQHIQQ")
#: The same in two: any record's, and a message's.
_RECORD: Final = Struct("<BQ")
_HEAD: Final = Struct("<HIQQ")
_HEAD_BYTES: Final = _HEAD.size
#: Where nothing was written: the first and the last time [ns].
_NEVER: Final = (2**63 - 1, 0)


class McapWriter:
    """Makes the bytes of one file; messages come by time.

    Attributes:
        counts: the number of messages of each channel.
        times_ns: the first and the last time of a message [ns].
    """

    def __init__(self) -> None:
        self._file = BytesIO()
        self._file.write(MAGIC)
        self._record(HEADER, _string("ros2") + _string(LIBRARY))
        self.counts: dict[int, int] = {}
        self.times_ns = _NEVER
        self._schemas: dict[str, bytes] = {}
        self._channels: list[bytes] = []
        self._chunk = bytearray()
        #: channel -> time and place of each of its messages in the chunk, one after the other
        self._index: dict[int, list[int]] = defaultdict(list)
        self._chunk_times_ns = _NEVER
        self._chunks: list[bytes] = []

    def add_channel(self, topic: str, kind: str, definition: str, type_hash: str) -> int:
        """Add the messages of a topic, of a ROS type with this definition; return its number."""
        if kind not in self._schemas:
            text = _string(kind) + _string("ros2msg") + _string(definition)
            self._schemas[kind] = pack("<H", len(self._schemas) + 1) + text
            self._chunk += _framed(SCHEMA, self._schemas[kind])
        number = len(self._channels) + 1
        # no QoS: `ros2 bag play` then offers the default, which suits every subscription here
        more = {"offered_qos_profiles": "[]", "topic_type_hash": type_hash}
        known = b"".join(_string(key) + _string(value) for key, value in more.items())
        channel = pack("<H", number) + self._schemas[kind][:2]
        channel += _string(topic) + _string("cdr") + pack("<I", len(known)) + known
        self._channels.append(channel)
        self._chunk += _framed(CHANNEL, channel)
        self.counts[number] = 0
        return number

    def write(self, channel: int, time_ns: int, data: bytes) -> None:
        """Write a message, which is in CDR."""
        self.counts[channel] += 1
        first_ns, last_ns = self._chunk_times_ns
        self._chunk_times_ns = min(first_ns, time_ns), max(last_ns, time_ns)
        chunk = self._chunk
        self._index[channel] += (time_ns, len(chunk))
        length = _HEAD_BYTES + len(data)
        chunk += _MESSAGE.pack(MESSAGE, length, channel, 0, time_ns, time_ns)
        chunk += data
        if len(chunk) > CHUNK_BYTES:
            self._close_chunk()

    def finish(self, metadata: str) -> bytes:
        """Write the rest, with rosbag2's metadata; return the file."""
        if self._chunk:
            self._close_chunk()
        place = self._file.tell()
        about = _string("serialized_metadata") + _string(metadata)
        self._record(METADATA, _string("rosbag2") + pack("<I", len(about)) + about)
        length = self._file.tell() - place
        self._record(DATA_END, pack("<I", 0))
        summary = self._file.tell()
        counts = b"".join(pack("<HQ", *count) for count in sorted(self.counts.items()))
        numbers = (len(self._schemas), len(self._channels), 0, 1, len(self._chunks))
        statistics = pack("<QHIIII", sum(self.counts.values()), *numbers)
        statistics += pack("<QQI", *self.times_ns, len(counts)) + counts
        parts = {
            SCHEMA: list(self._schemas.values()),
            CHANNEL: self._channels,
            CHUNK_INDEX: self._chunks,
            METADATA_INDEX: [pack("<QQ", place, length) + _string("rosbag2")],
            STATISTICS: [statistics],
        }
        offsets = []
        for kind, records in parts.items():
            begin = self._file.tell()
            for record in records:
                self._record(kind, record)
            if records:
                offsets.append(pack("<BQQ", kind, begin, self._file.tell() - begin))
        end = self._file.tell()
        for offset in offsets:
            self._record(SUMMARY_OFFSET, offset)
        self._record(FOOTER, pack("<QQI", summary, end, 0))
        self._file.write(MAGIC)
        return self._file.getvalue()

    def _close_chunk(self) -> None:
        times_ns, size = self._chunk_times_ns, len(self._chunk)
        self.times_ns = min(self.times_ns[0], times_ns[0]), max(self.times_ns[1], times_ns[1])
        packed = zstd.compress(bytes(self._chunk))
        compressed = _string("zstd") + pack("<Q", len(packed))
        place = self._file.tell()
        self._record(CHUNK, pack("<QQQI", *times_ns, size, 0) + compressed + packed)
        end = self._file.tell()
        offsets = b""
        for channel, entries in self._index.items():
            offsets += pack("<HQ", channel, self._file.tell())
            table = pack(f"<{len(entries)}Q", *entries)
            self._record(MESSAGE_INDEX, pack("<HI", channel, len(table)) + table)
        index = pack("<QQQQI", *times_ns, place, end - place, len(offsets)) + offsets
        index += pack("<Q", self._file.tell() - end) + compressed + pack("<Q", size)
        self._chunks.append(index)
        self._chunk, self._chunk_times_ns = bytearray(), _NEVER
        self._index.clear()

    def _record(self, kind: int, content: bytes) -> None:
        self._file.write(_framed(kind, content))


def _framed(kind: int, content: bytes) -> bytes:
    return _RECORD.pack(kind, len(content)) + content


def _string(text: str) -> bytes:
    data = text.encode()
    return pack("<I", len(data)) + data


# Reading ----------------------------------------------------------------------------------------


Ints = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Channel:
    """The n messages of a topic, in the order of the bag, as columns: no object for each of them.

    Attributes:
        topic: its name.
        msgtype: their ROS type, as 'std_msgs/msg/String'.
        times_ns: of each, from the start of the run [ns], int64 (n,).
        places: where each stands among all messages of the bag, int64 (n,).
        data: the bytes of the bag, uint8 (m,).
        begins, ends: where in `data` the CDR of each is, int64 (n,).
    """

    topic: str
    msgtype: str
    times_ns: Ints
    places: Ints
    data: npt.NDArray[np.uint8]
    begins: Ints
    ends: Ints

    def messages(self) -> Iterator[bytes]:
        """Yield the CDR of each message."""
        for begin, end in zip(self.begins.tolist(), self.ends.tolist(), strict=True):
            yield self.data[begin:end].tobytes()

    def rows(self, layout: np.dtype[np.void]) -> npt.NDArray[Any]:
        """Return all messages of a type with a CDR of fixed length, as a structured array (n,).

        Args:
            layout: of one message, with all of its bytes.
        """
        sizes = self.ends - self.begins
        other = sizes[sizes != layout.itemsize]
        if len(other):
            expected = f"a {self.msgtype} has {layout.itemsize} bytes"
            raise ValueError(f"{self.topic}: {expected}, found {other[0]}")
        if not len(self):
            return np.empty(0, layout)
        windows = np.lib.stride_tricks.sliding_window_view(self.data, layout.itemsize)
        return windows[self.begins].view(layout)[:, 0]

    def __len__(self) -> int:
        return len(self.times_ns)


def read_mcap(data: bytes, most_bytes: int = MOST_BYTES) -> list[Channel]:
    """Parse a file of `McapWriter`'s; return its channels, in their order.

    All is in its chunks: what stands behind the data is for readers that want part of it.

    Args:
        most_bytes: what it may decompress to.

    Raises:
        ValueError: it is damaged, or is none of these.
    """
    if not (data.startswith(MAGIC) and data.endswith(MAGIC)):
        raise ValueError("it does not begin and end as an MCAP file")
    found = _Found(most_bytes)
    try:
        for kind, begin, end in _records(data, len(MAGIC)):
            if kind == DATA_END:
                return found.channels()
            if kind == CHUNK:
                found.add(data[begin:end])
            elif kind == HEADER:
                if _text(data, begin)[0] != "ros2":
                    raise ValueError("its profile is not that of ROS 2")
            elif kind not in (MESSAGE_INDEX, METADATA):
                raise ValueError(f"a record of kind {kind} stands between its chunks")
    except (error, OverflowError) as damage:
        raise ValueError(f"a record is damaged: {damage}") from None
    raise ValueError("it has no end")


class _Found:
    """What the chunks of a file hold."""

    def __init__(self, most_bytes: int) -> None:
        self._most_bytes = most_bytes
        self._schemas: dict[int, str] = {}
        #: topics and types of the channels, and number of a channel -> its place among them
        self._topics: list[tuple[str, str]] = []
        self._places: dict[int, int] = {}
        self._chunks: list[bytes] = []
        self._size = 0
        #: of each message: time, place of its channel, where its data begins and ends
        self._messages: list[tuple[int, int, int, int]] = []

    def add(self, content: bytes) -> None:
        (size,) = unpack_from("<Q", content, 16)
        compression, at = _text(content, 28)
        (length,) = unpack_from("<Q", content, at)
        packed = content[at + 8 :]
        if compression not in ("zstd", "") or len(packed) != length:
            raise ValueError(f"expected a chunk compressed by zstd, found {compression!r:.20}")
        before, self._size = self._size, self._size + size
        if self._size > self._most_bytes:
            raise ValueError(f"expected {self._most_bytes:,} bytes at most, found {self._size:,}")
        chunk = zstd.decompress(packed, size) if compression else packed
        self._chunks.append(chunk)
        for kind, begin, end in _records(chunk, 0):
            if kind == MESSAGE:
                number, _, time_ns, _ = _HEAD.unpack_from(chunk, begin)
                begin += _HEAD_BYTES
                place = self._places.get(number, -1)
                self._messages.append((time_ns, place, before + begin, before + end))
            elif kind == CHANNEL:
                number, schema = unpack_from("<HH", chunk, begin)
                topic, at = _text(chunk, begin + 4)
                encoding, _ = _text(chunk, at)
                if number in self._places or schema not in self._schemas or encoding != "cdr":
                    raise ValueError(f"{topic!r:.80} is there twice, has no type or is not in CDR")
                self._places[number] = len(self._topics)
                self._topics.append((topic, self._schemas[schema]))
            elif kind == SCHEMA:
                (schema,) = unpack_from("<H", chunk, begin)
                self._schemas[schema] = _text(chunk, begin + 2)[0]
            else:
                raise ValueError(f"a record of kind {kind} stands among its messages")

    def channels(self) -> list[Channel]:
        columns = np.array(self._messages, np.int64).reshape(-1, 4)
        times_ns, places, begins, ends = columns.T
        if (places < 0).any() or (begins > ends).any():
            raise ValueError("a message is damaged, or of no channel")
        if (np.diff(times_ns) < 0).any():
            raise ValueError("its messages are not in the order of their times")
        data = np.frombuffer(b"".join(self._chunks), np.uint8)
        made = []
        for place, (topic, kind) in enumerate(self._topics):
            rows = np.flatnonzero(places == place)
            made.append(Channel(topic, kind, times_ns[rows], rows, data, begins[rows], ends[rows]))
        return made


def _records(data: bytes, at: int) -> Iterator[tuple[int, int, int]]:
    """Yield of each record what it is, and where its content begins and ends."""
    while at < len(data):
        kind, length = _RECORD.unpack_from(data, at)
        begin = at + _RECORD.size
        at = begin + length
        if at > len(data):
            raise ValueError("it is cut off")
        yield kind, begin, at


def _text(data: bytes, at: int) -> tuple[str, int]:
    """Return a string, and where it ends."""
    (length,) = unpack_from("<I", data, at)
    end = at + 4 + length
    if end > len(data):
        raise ValueError("it is cut off")
    return data[at + 4 : end].decode(), end
