"""Writes a recording as a rosbag2, real ROS messages in an MCAP file, and reads it. Needs no ROS.

The scene defines the topics, in its module `messages`.

A message's time is counted from the start of the run: a date would be the only thing in the bag
that differs between equal runs. Messages of equal times stand in the file in the order in which
they happened.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

from rosbags.interfaces import Connection
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from grader.errors import RecordingError
from grader.recording import rosbag2_reader
from grader.recording.rosbag2_writer import Record, Rosbag2Writer
from grader.recording.subject import Subject, Trace


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

    def records() -> Iterator[Record]:
        for time_ns, topic, msgtype, data in subject.to_messages(trace):
            yield connections.get(topic) or connection(topic, msgtype), time_ns, data

    with writer:
        for topic, msgtype in subject.bag_topics(trace):
            connection(topic, msgtype)
        writer.write_all(records())
    return folder / f"{folder.name}.mcap"


def read(mcap: Path, subject: Subject, duration_ns: int) -> Trace:
    """Read a bag that `write` has written; `duration_ns` is how long was recorded.

    Raises:
        RecordingError: it is damaged, or is another one.
    """
    folder = mcap.parent
    try:
        channels = rosbag2_reader.read(mcap)
    except MemoryError:  # a limit
        raise
    except Exception as error:  # where a bag is damaged, rosbags may raise anything
        raise RecordingError(f"cannot read the bag in {folder}: {_brief(error)}") from error
    try:
        return subject.from_channels(channels, duration_ns)
    except MemoryError:
        raise
    except Exception as error:  # and where a message is, too
        raise RecordingError(f"the bag in {folder} holds no recording: {_brief(error)}") from error


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


def _brief(error: Exception) -> str:
    """Format an exception without its repr, which for a decoding error is the whole file."""
    return f"{type(error).__name__}: {error!s:.200}"
