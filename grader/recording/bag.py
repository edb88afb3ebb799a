"""A recording as a rosbag2: real ROS messages in an MCAP file, and back. No ROS is needed.

| topic | type | one message is |
|---|---|---|
| /NAME/pose | turtlesim/msg/Pose | what turtle NAME published in a tick |
| /NAME/color_sensor | turtlesim/msg/Color | ... and the colour under it |
| /NAME/cmd_vel | geometry_msgs/msg/Twist | a velocity command that reached it |
| /turtlesim/events | std_msgs/msg/String | any other input: a scenario event as JSON |
| /rosout | rcl_interfaces/msg/Log | a line of the simulator's log |
| /turtlesim/path | sensor_msgs/msg/Image | at the end: what the pens drew, rgba8 |
| /turtlesim/window | sensor_msgs/msg/Image | at the end: the original's window, rgb8 |

A message's time is its tick times 16 ms, counted from the start of the run: the turtle's own time.
A date would be the only thing in the bag that differs between equal runs. Messages of one tick have
equal times and stand in the file in the order in which they happened.
"""

from __future__ import annotations

from pathlib import Path

from rosbags.interfaces import Connection
from rosbags.rosbag2 import CompressionFormat, CompressionMode, Reader, StoragePlugin, Writer

from grader.recording.messages import POSE, Contents, Item, contents, items, store, topics
from grader.recording.recording import Recording, RecordingError
from turtlesim_py.world.arena import TICK_NS

METADATA = "metadata.yaml"


def write(recording: Recording, folder: Path) -> Path:
    """Write a bag; returns its .mcap, which is named like the folder. Last comes `METADATA`.

    The same recording gives the same bytes.

    Raises:
        OSError: it cannot be written, e.g. because the disk is full.
    """
    types = store()
    writer = Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP)
    # Chunks inside the file: 0.2 MB instead of 2 MB a run, and every reader of MCAP can unpack it.
    writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
    connections: dict[str, Connection] = {}

    def connection(topic: str, msgtype: str) -> Connection:
        # No QoS: `ros2 bag play` then offers the default, which suits every subscription here.
        if topic not in connections:
            connections[topic] = writer.add_connection(topic, msgtype, typestore=types)
        return connections[topic]

    with writer:
        for turtle in recording.published:  # also those without a row, and all in this order
            for topic, msgtype in topics(turtle).items():
                connection(topic, msgtype)
        for tick, topic, msgtype, message in items(recording):
            data = types.serialize_cdr(message, msgtype, little_endian=True)
            writer.write(connection(topic, msgtype), tick * TICK_NS, data)
    return folder / f"{folder.name}.mcap"


def read(folder: Path) -> Contents:
    """Read a bag that `write` has written.

    Raises:
        RecordingError: it is damaged, or is another one.
    """
    types = store()
    try:
        with Reader(folder) as reader:
            turtles = [
                c.topic.removeprefix("/").removesuffix("/pose")
                for c in reader.connections
                if c.msgtype == POSE
            ]
            found = [
                Item(time_ns // TICK_NS, c.topic, c.msgtype, types.deserialize_cdr(data, c.msgtype))
                for c, time_ns, data in reader.messages()
            ]
    except Exception as error:  # where a bag is damaged, rosbags may raise anything
        raise RecordingError(f"cannot read the bag in {folder}: {_brief(error)}") from error
    try:
        return contents(found, turtles)
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise RecordingError(f"the bag in {folder} holds no recording: {_brief(error)}") from error


def _brief(error: Exception) -> str:
    """Not its repr, which for a decoding error is the whole file."""
    return f"{type(error).__name__}: {error!s:.200}"
