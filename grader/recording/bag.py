"""A recording as a rosbag2: real ROS messages in an MCAP file, and back. No ROS is needed.

Which topics hold what is told by the scene, in its module `messages`.

A message's time is its tick times the tick's length, counted from the start of the run: the scene's
own time. A date would be the only thing in the bag that differs between equal runs. Messages of one
tick have equal times and stand in the file in the order in which they happened.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from rosbags.interfaces import Connection

from grader.errors import RecordingError
from grader.recording import rosbag2_reader
from grader.recording.rosbag2_writer import Record, Rosbag2Writer
from grader.scenes.message_types import types_of
from grader.scenes.scene import Scene, Trace


def write(trace: Trace, scene: Scene, folder: Path) -> Path:
    """Write a bag; returns its .mcap, which is named like the folder. Last comes metadata.yaml.

    The same trace gives the same bytes.

    Raises:
        OSError: it cannot be written, e.g. because the disk is full.
    """
    types = types_of(scene.message_definitions())
    writer = Rosbag2Writer(folder)
    connections: dict[str, Connection] = {}

    def connection(topic: str, msgtype: str) -> Connection:
        # No QoS: `ros2 bag play` then offers the default, which suits every subscription here.
        if topic not in connections:
            connections[topic] = writer.add_connection(topic, msgtype, typestore=types)
        return connections[topic]

    def records() -> Iterator[Record]:
        tick_ns = scene.tick_ns
        for tick, topic, msgtype, data in scene.to_messages(trace):
            yield connections.get(topic) or connection(topic, msgtype), tick * tick_ns, data

    with writer:
        for topic, msgtype in scene.bag_topics(trace):
            connection(topic, msgtype)
        writer.write_all(records())
    return folder / f"{folder.name}.mcap"


def read(mcap: Path, scene: Scene, ticks: int) -> Trace:
    """Read a bag that `write` has written; `ticks` is how many were recorded.

    Raises:
        RecordingError: it is damaged, or is another one.
    """
    folder = mcap.parent
    try:
        channels = rosbag2_reader.read(mcap, scene.tick_ns)
    except MemoryError:  # a limit
        raise
    except Exception as error:  # where a bag is damaged, rosbags may raise anything
        raise RecordingError(f"cannot read the bag in {folder}: {_brief(error)}") from error
    try:
        return scene.from_channels(channels, ticks)
    except MemoryError:
        raise
    except Exception as error:  # and where a message is, too
        raise RecordingError(f"the bag in {folder} holds no recording: {_brief(error)}") from error


def _brief(error: Exception) -> str:
    """Not its repr, which for a decoding error is the whole file."""
    return f"{type(error).__name__}: {error!s:.200}"
