"""Writes a recording as a rosbag2, real ROS messages in an MCAP file, and reads it. Needs no ROS.

The scene defines the topics, in its module `messages`.

A message's time is counted from the start of the run: a date would be the only thing in the bag
that differs between equal runs. Messages of equal times stand in the file in the order in which
they happened.

Two things are added that rosbag2 writes and rosbags does not:

| what | where |
|---|---|
| `topic_type_hash`, by which a type is known on the graph | metadata of each channel in the .mcap |
| `ros_distro`, whose types these are | metadata.yaml, and its copy in the .mcap |
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any, Final

import numpy as np
import yaml
from rosbags.interfaces import Connection
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.storage_mcap import McapReader, McapWriter, write_channel, write_string
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from grader.errors import RecordingError
from grader.recording.channel import Channel, divided
from grader.recording.subject import Subject, Trace

#: Under whichever ROS a run was made: the bag's definitions are those of Jazzy.
DISTRO = "jazzy"
#: The C library's, where PyYAML has it: ten times as fast, and as safe.
_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
#: Of metadata.yaml.
_VERSION: Final = 9


def write(trace: Trace, subject: Subject, folder: Path) -> Path:
    """Write a bag; returns its .mcap, which is named like the folder. Last comes metadata.yaml.

    The same trace gives the same bytes.

    Raises:
        OSError: it cannot be written, e.g. because the disk is full.
    """
    types = types_of(subject.definitions_of(trace))
    writer = Rosbag2Writer(folder)
    connections: dict[str, Connection] = {}

    def connection(topic: str, msgtype: str) -> Connection:
        # No QoS: `ros2 bag play` then offers the default, which suits every subscription here.
        if topic not in connections:
            connections[topic] = writer.add_connection(topic, msgtype, typestore=types)
        return connections[topic]

    with writer:
        for topic, msgtype in subject.bag_topics(trace):
            connection(topic, msgtype)
        for time_ns, topic, msgtype, data in subject.to_messages(trace):
            writer.write(connection(topic, msgtype), time_ns, data)
    return folder / f"{folder.name}.mcap"


def read(mcap: Path, subject: Subject, duration_ns: int) -> Trace:
    """Read a bag that `write` has written; `duration_ns` is how long was recorded.

    Raises:
        RecordingError: it is damaged, or is another one.
    """
    wrong = f"cannot read the bag in {mcap.parent}"
    try:
        channels = read_channels(mcap)
        wrong = f"the bag in {mcap.parent} holds no recording"
        return subject.from_channels(channels, duration_ns)
    except MemoryError:  # a limit
        raise
    except Exception as error:  # where a bag or a message is damaged, its reader may raise anything
        # without the error's repr: for a decoding error that is the whole file
        raise RecordingError(f"{wrong}: {type(error).__name__}: {error!s:.200}") from error


def types_of(definitions: Mapping[str, str]) -> Typestore:
    """Return a typestore of the types that are defined, and of builtin_interfaces.

    rosbags has the types of ROS 2 Jazzy, but importing them lasts longer than a run's verdict: they
    are built on those of each release before.

    Args:
        definitions: ROS type -> the text of its .msg; also of the types of its fields.
    """
    return _store(tuple(definitions.items()))


@cache  # the code that (de)serializes a type is compiled once a store
def _store(definitions: tuple[tuple[str, str], ...]) -> Typestore:
    types = get_typestore(Stores.EMPTY)
    for msgtype, text in definitions:
        types.register(get_types_from_msg(text, msgtype))
    return types


# Writing --------------------------------------------------------------------------------------


class _Storage(McapWriter):
    """The .mcap."""

    def add_connection(self, connection: Connection, offered_qos_profiles: str) -> None:
        """Write a channel with the hash of its type."""
        records = self.chunk.bio
        begin = records.tell()
        super().add_connection(connection, offered_qos_profiles)
        more = BytesIO()
        write_string(more, "topic_type_hash")
        write_string(more, connection.digest)
        channel = self.channels.pop()
        channel = channel._replace(metadata=channel.metadata + more.getvalue())
        self.channels.append(channel)
        # A channel's record stands among the messages too, and may be there once only.
        records.seek(begin)
        records.truncate()
        write_channel(records, channel, self.schemas)

    def close(self, version: int, metadata: str) -> None:
        """Write the rest, the metadata too."""
        super().close(version, _with_distro(metadata))


class Rosbag2Writer(Writer):
    """Writes a bag into a new folder; a context manager, as rosbags' own."""

    STORAGE_PLUGINS: Mapping[StoragePlugin, type[McapWriter]] = {StoragePlugin.MCAP: _Storage}

    def __init__(self, folder: Path) -> None:
        super().__init__(folder, version=_VERSION, storage_plugin=StoragePlugin.MCAP)
        # Chunks inside the file: 0.2 MB instead of 2 MB a run, and every reader of MCAP can
        # unpack it.
        self.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)

    def close(self) -> None:
        """Finish the bag; last comes metadata.yaml."""
        super().close()
        text = self.metapath.read_text(encoding="utf-8")
        whole = self.metapath.with_suffix(".yaml.tmp")
        whole.write_text(_with_distro(text), encoding="utf-8")
        whole.replace(self.metapath)


def _with_distro(metadata: str) -> str:
    return metadata.replace("ros_distro: rosbags", f"ros_distro: {DISTRO}")


# Reading --------------------------------------------------------------------------------------


def read_channels(mcap: Path) -> list[Channel]:
    """Read the channels of a bag, in their order; beside its .mcap lies its metadata.yaml.

    Raises:
        ValueError: it is damaged, or is none of ours.
        Exception: rosbags' and yaml's own.
    """
    reader = McapReader(mcap)
    reader.open()
    try:
        topics = {c.id: (c.topic, c.msgtype) for c in reader.connections}
        found = list(reader.messages(reader.connections))
    finally:
        reader.close()
    places = {id: number for number, id in enumerate(topics)}
    columns = [(time_ns, places[of.id], len(cdr)) for of, time_ns, cdr in found]
    times_ns, numbers, sizes = np.array(columns, np.int64).reshape(-1, 3).T
    data = np.frombuffer(b"".join(cdr for _, _, cdr in found), np.uint8)
    channels = divided(list(topics.values()), times_ns, numbers, sizes, data)
    _check_metadata(mcap, channels)
    return channels


def _check_metadata(mcap: Path, channels: list[Channel]) -> None:
    """Check that metadata.yaml describes this bag, for readers that use it."""
    text = mcap.with_name("metadata.yaml").read_text(encoding="utf-8")
    about = yaml.load(text, _Loader)["rosbag2_bagfile_information"]
    right = {
        "version": _VERSION,
        "storage_identifier": "mcap",
        "relative_file_paths": [mcap.name],
        "compression_mode": "",
        "message_count": sum(map(len, channels)),
    }
    for key, value in right.items():
        if about[key] != value:
            raise ValueError(f"metadata.yaml: {key} is {about[key]!r:.80}, not {value!r}")
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
