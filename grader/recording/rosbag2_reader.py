"""Reads a bag that `grader.recording.rosbag2_writer` has written, by columns, and no other.

rosbags reads any bag, message by message. Ours have thousands of messages of a few types, and are
indexed: all messages of a channel are found at once where the index says they are. The index
is not trusted: each entry has to be a message of that channel and time, and between them there must
be none that the index leaves out. So it finds the same as a reader that goes from record to record.
"""

from __future__ import annotations

from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import yaml
from rosbags.rosbag2.storage_mcap import ChunkInfo, McapReader, decompress, read_exact

from grader.recording.channel import Channel, Ints, records_at

#: The head of a message in MCAP.
_HEAD = np.dtype(
    [
        *(("opcode", "u1"), ("length", "<u8"), ("channel", "<u2"), ("sequence", "<u4")),
        *(("log_ns", "<u8"), ("publish_ns", "<u8")),
    ]
)
#: The part of it that `length` does not count.
_LENGTH_BYTES = 9
_MESSAGE, _CHUNK, _INDEX = 0x05, 0x06, 0x07
#: The C library's, where PyYAML has it: ten times as fast, and as safe.
_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
#: The oldest and the newest version of metadata.yaml that rosbags reads.
_VERSIONS = range(1, 10)


class _Messages(NamedTuple):
    """Messages of several channels in the order of the file; int64 (n,) each."""

    channels: Ints
    times_ns: Ints
    begins: Ints
    ends: Ints


def read(mcap: Path) -> list[Channel]:
    """Read the channels of a bag, in their order; beside its .mcap lies its metadata.yaml.

    Raises:
        ValueError: it is damaged, or is none of ours.
        Exception: rosbags' and yaml's own.
    """
    reader = McapReader(mcap)
    reader.open()
    try:
        topics = {c.id: (c.topic, c.msgtype) for c in reader.connections}
        data, found = _all_messages(reader, set(topics))
    finally:
        reader.close()
    channels = _by_channel(topics, data, found)
    _check_metadata(mcap, channels)
    return channels


# The .mcap ------------------------------------------------------------------------------------


def _all_messages(reader: McapReader, known: set[int]) -> tuple[npt.NDArray[np.uint8], _Messages]:
    """Return the unpacked bytes of all chunks, and the messages in them."""
    chunks, parts, begin = [], [], 0
    for info in sorted(reader.chunks, key=lambda chunk: chunk.chunk_start_offset):
        chunk = np.frombuffer(_unpacked(reader, info), np.uint8)
        part = _messages(chunk, _index(reader, info, known))
        parts.append(part._replace(begins=part.begins + begin, ends=part.ends + begin))
        chunks.append(chunk)
        begin += len(chunk)
    if not chunks:
        raise ValueError("it has no chunks")
    found = _Messages(*(np.concatenate(column) for column in zip(*parts, strict=True)))
    if (np.diff(found.times_ns) < 0).any():
        raise ValueError("messages are not in the order of their times")
    return np.concatenate(chunks), found


def _unpacked(reader: McapReader, info: ChunkInfo) -> bytes:
    """Unpack a chunk; rosbags compares its size and its checksum."""
    head = BytesIO(_record(reader, info.chunk_start_offset, _CHUNK))
    head.seek(24)
    crc = int.from_bytes(read_exact(head, 4), "little")
    name = read_exact(head, int.from_bytes(read_exact(head, 4), "little")).decode()
    packed = read_exact(head, int.from_bytes(read_exact(head, 8), "little"))
    return decompress(packed, name, info.uncompressed_size, crc)


def _index(
    reader: McapReader, info: ChunkInfo, known: set[int]
) -> dict[int, npt.NDArray[np.uint64]]:
    """Read the index of a chunk: channel -> times [ns] and places in the unpacked chunk, (n, 2)."""
    found = {}
    for channel, offset in info.message_index_offsets.items():
        if channel not in known:
            raise ValueError(f"an index is of a channel {channel} that there is not")
        record = _record(reader, offset, _INDEX)
        number, size = int.from_bytes(record[:2], "little"), int.from_bytes(record[2:6], "little")
        if number != channel or size != len(record) - 6 or size % 16:
            raise ValueError(f"the index of channel {channel} is damaged")
        found[channel] = np.frombuffer(record, "<u8", offset=6).reshape(-1, 2)
    return found


def _record(reader: McapReader, offset: int, opcode: int) -> bytes:
    file = reader.bio
    assert file is not None
    file.seek(offset)
    if read_exact(file, 1)[0] != opcode:
        raise ValueError(f"at {offset} there is no record of the kind {opcode}")
    return read_exact(file, int.from_bytes(read_exact(file, 8), "little"))


def _messages(
    chunk: npt.NDArray[np.uint8], index: Mapping[int, npt.NDArray[np.uint64]]
) -> _Messages:
    """Find all messages in a chunk by its index, and check that they are there."""
    channels = np.repeat(np.array([*index], np.int64), [len(rows) for rows in index.values()])
    entries = np.concatenate([np.empty((0, 2), np.uint64), *index.values()])
    is_outside = entries[:, 1] > max(len(chunk) - _HEAD.itemsize, 0)
    if is_outside.any() or (entries[:, 0] >= 2**63).any():
        raise ValueError("an index leads out of its chunk")
    order = np.argsort(entries[:, 1], kind="stable")
    channels, (times, places) = channels[order], entries[order].T.astype(np.int64)
    heads = records_at(chunk, places, _HEAD)
    room = len(chunk) - places - _LENGTH_BYTES
    is_right = (
        (heads["opcode"] == _MESSAGE)
        & (heads["channel"] == channels)
        & (heads["log_ns"] == times.astype(np.uint64))
        & (heads["length"] >= _HEAD.itemsize - _LENGTH_BYTES)
        & (heads["length"] <= room.astype(np.uint64))
    )
    if not is_right.all():
        raise ValueError("an index tells of messages that there are not")
    ends = places + _LENGTH_BYTES + heads["length"].astype(np.int64)
    _check_between(chunk, np.append(0, ends), np.append(places, len(chunk)))
    return _Messages(channels, times, places + _HEAD.itemsize, ends)


def _check_between(chunk: npt.NDArray[np.uint8], begins: Ints, ends: Ints) -> None:
    """Check that there are only other records between, before and after the messages."""
    if (begins > ends).any():
        raise ValueError("messages overlap")
    for n in np.flatnonzero(begins < ends).tolist():
        at, end = int(begins[n]), int(ends[n])
        while at < end:
            if chunk[at] == _MESSAGE:
                raise ValueError("a message is missing in the index")
            size = chunk[at + 1 : at + _LENGTH_BYTES].tobytes()
            at += _LENGTH_BYTES + int.from_bytes(size, "little")
        if at != end:
            raise ValueError("a record is longer than there is room")


def _by_channel(
    topics: Mapping[int, tuple[str, str]],
    data: npt.NDArray[np.uint8],
    found: _Messages,
) -> list[Channel]:
    order = np.argsort(found.channels, kind="stable")
    channels = found.channels[order]
    made = []
    for number, (topic, msgtype) in topics.items():
        begin, end = np.searchsorted(channels, [number, number + 1])
        rows = order[begin:end]
        place = found.begins[rows], found.ends[rows]
        made.append(
            Channel(topic, msgtype, found.times_ns[rows], rows.astype(np.int64), data, *place)
        )
    return made


# metadata.yaml --------------------------------------------------------------------------------


def _check_metadata(mcap: Path, channels: list[Channel]) -> None:
    """Check that metadata.yaml describes this bag, for readers that use it."""
    text = mcap.with_name("metadata.yaml").read_text(encoding="utf-8")
    about = yaml.load(text, _Loader)["rosbag2_bagfile_information"]
    right = {
        "storage_identifier": "mcap",
        "relative_file_paths": [mcap.name],
        "compression_mode": "",
        "message_count": sum(map(len, channels)),
    }
    for key, value in right.items():
        if about[key] != value:
            raise ValueError(f"metadata.yaml: {key} is {about[key]!r:.80}, not {value!r}")
    if about["version"] not in _VERSIONS:
        raise ValueError(f"metadata.yaml is of the version {about['version']!r:.80}")
    listed = {
        topic["topic_metadata"]["name"]: (
            *(topic["topic_metadata"][key] for key in ("type", "serialization_format")),
            topic["message_count"],
        )
        for topic in about["topics_with_message_count"]
    }
    right_topics = {c.topic: (c.msgtype, "cdr", len(c)) for c in channels}
    if listed != right_topics or len(listed) < len(channels):
        raise ValueError("metadata.yaml tells of other topics, or two channels have the same one")
