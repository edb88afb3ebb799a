"""A trace as ROS messages, and back.

| topic | type | one message is |
|---|---|---|
| /NAME/pose | turtlesim/msg/Pose | what turtle NAME published in a tick |
| /NAME/color_sensor | turtlesim/msg/Color | ... and the colour under it |
| /NAME/cmd_vel | geometry_msgs/msg/Twist | a velocity command that reached it |
| /turtlesim/events | std_msgs/msg/String | any other input: a scenario event as JSON |
| /rosout | rcl_interfaces/msg/Log | a line of the simulator's log |
| /turtlesim/path | sensor_msgs/msg/Image | at the end: what the pens drew, rgba8 |
| /turtlesim/window | sensor_msgs/msg/Image | at the end: the original's window, rgb8 |
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from itertools import chain
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from grader.recording.mcap import Channel
from grader.recording.subject import BagMessage, Pixels
from grader.ros.bag_types import BagTypes
from grader.ros.cdr import MARK, CdrReader, string, string_of
from grader.scenes.turtlesim.trace import Log, TurtleTrace, check
from grader.scenes.view import Times
from turtlesim_py.world.arena import TICK_NS
from turtlesim_py.world.events import CmdVel, Event, EventError, from_json, to_json
from turtlesim_py.world.trajectory import Trajectory

Value = TypeVar("Value")

POSE, COLOR, TWIST = "turtlesim/msg/Pose", "turtlesim/msg/Color", "geometry_msgs/msg/Twist"
STRING, LOG, IMAGE = "std_msgs/msg/String", "rcl_interfaces/msg/Log", "sensor_msgs/msg/Image"
_TYPES = BagTypes({})
#: A pose, a colour and a command as CDR: the mark of little-endian plain CDR, then the fields.
_CDR_MARK = tuple(MARK)
_POSE_CDR = np.dtype([("mark", "u1", 4), ("fields", "<f4", 5)])
_COLOR_CDR = np.dtype([("mark", "u1", 4), ("fields", "u1", 3)])
_TWIST_CDR = np.dtype([("mark", "u1", 4), ("fields", "<f8", 6)])
EVENTS, LOGS = "/turtlesim/events", "/rosout"
PATH, WINDOW = "/turtlesim/path", "/turtlesim/window"
ENCODINGS = {PATH: "rgba8", WINDOW: "rgb8"}
#: rcl_interfaces/msg/Log's levels.
LEVELS = {"DEBUG": 10, "INFO": 20, "WARN": 30, "ERROR": 40, "FATAL": 50}
SEVERITIES = {level: severity for severity, level in LEVELS.items()}


def topics(turtle: str) -> dict[str, str]:
    """Return the topics that a turtle publishes, with their types."""
    return {f"/{turtle}/pose": POSE, f"/{turtle}/color_sensor": COLOR}


# A trace to messages --------------------------------------------------------------------------


def to_messages(trace: TurtleTrace) -> list[BagMessage]:
    """Return all messages by time; within a tick inputs, logs, readings, pictures."""
    logs = (
        BagMessage(tick * TICK_NS, LOGS, LOG, _log(tick, severity, name, text))
        for tick, severity, name, text in trace.logs
    )
    readings = (_readings(name, way) for name, way in trace.trajectories.items())
    end = trace.ticks
    pictures = (
        BagMessage(end * TICK_NS, topic, IMAGE, _image(pixels, ENCODINGS[topic], end))
        for topic, pixels in ((PATH, trace.canvas), (WINDOW, trace.window))
    )
    found = chain(map(of_input, trace.events), logs, *readings, pictures)
    return sorted(found, key=lambda message: message.time_ns)


def _readings(turtle: str, way: Trajectory) -> Iterator[BagMessage]:
    """Serialise the readings of a turtle: by columns, since they are most of a bag."""
    pose_topic, color_topic = topics(turtle)
    rows = way.rows()
    poses, colors = _cdr(rows[:, 1:6], _POSE_CDR), _cdr(rows[:, 6:9], _COLOR_CDR)
    for tick, pose, color in zip(way.ticks.tolist(), poses, colors, strict=True):
        yield BagMessage(tick * TICK_NS, pose_topic, POSE, pose)
        yield BagMessage(tick * TICK_NS, color_topic, COLOR, color)


def _cdr(columns: npt.NDArray[np.float64], layout: np.dtype[np.void]) -> list[bytes]:
    """Serialise each row as a message."""
    packed = np.empty(len(columns), layout)
    packed["mark"] = _CDR_MARK
    packed["fields"] = columns
    data, size = packed.tobytes(), layout.itemsize
    return [data[begin : begin + size] for begin in range(0, len(data), size)]


def of_input(event: Event) -> BagMessage:
    """Serialise an input: a velocity command as a Twist, all others as JSON."""
    if isinstance(event, CmdVel):
        fields = np.array([[*event.linear, *event.angular]])
        (twist,) = _cdr(fields, _TWIST_CDR)
        return BagMessage(event.tick * TICK_NS, f"/{event.turtle}/cmd_vel", TWIST, twist)
    return BagMessage(event.tick * TICK_NS, EVENTS, STRING, string(json.dumps(to_json(event))))


def _log(tick: int, severity: str, name: str, text: str) -> bytes:
    values = {"stamp": _stamp(tick), "level": LEVELS[severity], "name": name, "msg": text}
    return _TYPES.data(LOG, {**values, "file": "", "function": "", "line": 0})


def _image(pixels: Pixels, encoding: str, tick: int) -> bytes:
    height, width, channels = pixels.shape
    values = {"header": {"stamp": _stamp(tick), "frame_id": ""}, "height": height, "width": width}
    layout = {"encoding": encoding, "is_bigendian": 0, "step": width * channels}
    return _TYPES.data(IMAGE, {**values, **layout, "data": pixels.ravel()})


def _stamp(tick: int) -> dict[str, int]:
    seconds, nanoseconds = divmod(tick * TICK_NS, 1_000_000_000)
    return {"sec": seconds, "nanosec": nanoseconds}


# Channels to a trace --------------------------------------------------------------------------


def from_channels(channels: Sequence[Channel], ticks: int) -> TurtleTrace:
    """Parse the channels of a bag, each with a different topic, into a trace."""
    by_topic = {channel.topic: channel for channel in channels}
    events: list[tuple[int, Event]] = []
    logs: list[tuple[int, Log]] = []
    turtles: list[str] = []
    for topic, channel in by_topic.items():
        match channel.msgtype:
            case "turtlesim/msg/Pose":
                turtles.append(topic.removeprefix("/").removesuffix("/pose"))
            case "geometry_msgs/msg/Twist":
                events += zip(channel.places.tolist(), _commands(channel), strict=True)
            case "std_msgs/msg/String":
                events += zip(channel.places.tolist(), _inputs(channel), strict=True)
            case "rcl_interfaces/msg/Log":
                logs += zip(channel.places.tolist(), _logs(channel), strict=True)
            case "turtlesim/msg/Color" if topic.endswith("/color_sensor"):
                pass  # comes with the poses
            case "sensor_msgs/msg/Image" if topic in ENCODINGS:
                pass
            case msgtype:
                raise ValueError(f"a recording of turtlesim has no {msgtype} on {topic}")
    trace = TurtleTrace(
        ticks=ticks,
        events=_in_order(events),
        trajectories={
            turtle: _trajectory(*(by_topic[topic] for topic in topics(turtle)))
            for turtle in turtles
        },
        logs=_in_order(logs),
        canvas=_picture(by_topic[PATH]),
        window=_picture(by_topic[WINDOW]),
    )
    check(trace)
    return trace


def _in_order(found: list[tuple[int, Value]]) -> tuple[Value, ...]:
    return tuple(value for _, value in sorted(found, key=lambda each: each[0]))


def _ticks(channel: Channel) -> Times:
    return channel.times_ns // TICK_NS


def _rows(channel: Channel, msgtype: str, layout: np.dtype[np.void]) -> npt.NDArray[Any]:
    """Return the fields of all messages of a channel, (n, number of fields)."""
    if channel.msgtype != msgtype:
        raise ValueError(f"{channel.topic}: expected a {msgtype}, found a {channel.msgtype}")
    rows = channel.rows(layout)
    if (rows["mark"] != _CDR_MARK).any():
        raise ValueError(f"{channel.topic}: a message is no plain little-endian CDR")
    return np.asarray(rows["fields"])


def _commands(channel: Channel) -> Iterator[CmdVel]:
    turtle = channel.topic.removeprefix("/").removesuffix("/cmd_vel")
    rows = _rows(channel, TWIST, _TWIST_CDR)
    for tick, (x, y, z, *turn) in zip(_ticks(channel).tolist(), rows.tolist(), strict=True):
        yield CmdVel(tick=tick, turtle=turtle, linear=(x, y, z), angular=tuple(turn))


def _inputs(channel: Channel) -> Iterator[Event]:
    for data in channel.messages():
        words = json.loads(text := string_of(data))
        if not isinstance(words, dict):
            raise EventError(f"an event is an object, found {text:.80}")
        yield from_json(words)


def _logs(channel: Channel) -> Iterator[Log]:
    for tick, data in zip(_ticks(channel).tolist(), channel.messages(), strict=True):
        values = _TYPES.values(data, LOG)
        yield Log(tick, SEVERITIES[values["level"]], values["name"], values["msg"])


def _trajectory(poses: Channel, colors: Channel) -> Trajectory:
    if not np.array_equal(poses.times_ns, colors.times_ns):
        raise ValueError(f"{len(poses)} poses and {len(colors)} colours do not belong together")
    found = _rows(poses, POSE, _POSE_CDR), _rows(colors, COLOR, _COLOR_CDR)
    return Trajectory.of_rows(np.column_stack((_ticks(poses), *found)).astype(np.float64))


def _picture(channel: Channel) -> Pixels:
    if channel.msgtype != IMAGE or len(channel) != 1:
        found = f"{len(channel)} of {channel.msgtype}"
        raise ValueError(f"{channel.topic}: expected one {IMAGE}, found {found}")
    read = CdrReader(next(channel.messages()))
    read.number("i"), read.number("I"), read.text()  # its header
    height, width, encoding = read.number("I"), read.number("I"), read.text()
    read.number("B"), read.number("I")
    data = read.octets()
    read.end()
    expected = ENCODINGS[channel.topic]
    if encoding != expected:
        raise ValueError(f"a picture has the encoding {encoding!r:.40}, expected {expected!r}")
    return np.frombuffer(data, np.uint8).reshape(height, width, len(expected) - 1)
