"""A recording as ROS messages, and back; `grader.recording.bag` says which topic holds what."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cache
from itertools import chain
from operator import attrgetter
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore
from rosbags.typesys.stores import ros2_jazzy as ros

from grader.recording.recording import Recording
from turtlesim_py.replay import number
from turtlesim_py.world.arena import TICK_NS

POSE, COLOR, TWIST = "turtlesim/msg/Pose", "turtlesim/msg/Color", "geometry_msgs/msg/Twist"
STRING, LOG, IMAGE = "std_msgs/msg/String", "rcl_interfaces/msg/Log", "sensor_msgs/msg/Image"
#: rosbags knows no turtlesim, and where ROS is not sourced there may be no share/turtlesim to ask.
DEFINITIONS = {
    POSE: "float32 x\nfloat32 y\nfloat32 theta\n"
    "float32 linear_velocity\nfloat32 angular_velocity\n",
    COLOR: "uint8 r\nuint8 g\nuint8 b\n",
}
EVENTS, LOGS = "/turtlesim/events", "/rosout"
PATH, WINDOW = "/turtlesim/path", "/turtlesim/window"
ENCODINGS = {PATH: "rgba8", WINDOW: "rgb8"}
#: rcl_interfaces/msg/Log's levels.
LEVELS = {"DEBUG": 10, "INFO": 20, "WARN": 30, "ERROR": 40, "FATAL": 50}
_POSE_FIELDS = attrgetter("x", "y", "theta", "linear_velocity", "angular_velocity")
SEVERITIES = {level: severity for severity, level in LEVELS.items()}

Rows = npt.NDArray[np.float64]
Pixels = npt.NDArray[np.uint8]


class Item(NamedTuple):
    """One message: its tick, topic and type, and itself."""

    tick: int
    topic: str
    msgtype: str
    message: Any


class Contents(NamedTuple):
    """What messages hold of a recording; see the attributes of `Recording`."""

    events: tuple[dict[str, Any], ...]
    published: dict[str, Rows]
    logs: tuple[list[Any], ...]
    canvas: Pixels
    window: Pixels


@cache
def store() -> Typestore:
    """The types of ROS 2 Jazzy and turtlesim's."""
    types = get_typestore(Stores.ROS2_JAZZY)
    for msgtype, text in DEFINITIONS.items():
        types.register(get_types_from_msg(text, msgtype))
    return types


def topics(turtle: str) -> dict[str, str]:
    """The topics of a turtle that publishes, with their types."""
    return {f"/{turtle}/pose": POSE, f"/{turtle}/color_sensor": COLOR}


# A recording to messages ----------------------------------------------------------------------


def items(recording: Recording) -> list[Item]:
    """All messages by tick; within a tick inputs, logs, readings, and pictures last."""
    logs = (
        Item(tick, LOGS, LOG, _log(tick, severity, name, text))
        for tick, severity, name, text in recording.logs
    )
    readings = (_readings(name, rows) for name, rows in recording.published.items())
    end = recording.run.ticks
    pictures = (
        Item(end, topic, IMAGE, _image(pixels, ENCODINGS[topic], end))
        for topic, pixels in ((PATH, recording.canvas), (WINDOW, recording.window))
    )
    found = chain(map(_input, recording.events), logs, *readings, pictures)
    return sorted(found, key=lambda item: item.tick)


def _readings(turtle: str, rows: Rows) -> Iterator[Item]:
    pose_of, color_of = store().types[POSE], store().types[COLOR]
    pose_topic, color_topic = topics(turtle)
    for tick, *pose, r, g, b in rows.tolist():
        yield Item(int(tick), pose_topic, POSE, pose_of(*pose))
        yield Item(int(tick), color_topic, COLOR, color_of(int(r), int(g), int(b)))


def _input(event: dict[str, Any]) -> Item:
    """An event as a Twist where that says exactly the same, else as JSON."""
    tick, text = event["tick"], json.dumps(event)
    with suppress(KeyError, TypeError, ValueError, OverflowError):  # no velocity command
        topic = f"/{event['turtle']}/cmd_vel"
        linear, angular = (map(float, event[key]) for key in ("linear", "angular"))
        vectors = (
            ros.geometry_msgs__msg__Vector3(*linear),
            ros.geometry_msgs__msg__Vector3(*angular),
        )
        twist = ros.geometry_msgs__msg__Twist(*vectors)
        if json.dumps(_command(tick, topic, twist)) == text:
            return Item(tick, topic, TWIST, twist)
    return Item(tick, EVENTS, STRING, ros.std_msgs__msg__String(text))


def _log(tick: int, severity: str, name: str, text: str) -> Any:
    # CDR is UTF-8, which cannot hold half a surrogate pair.
    text = text.encode("utf-8", "replace").decode("utf-8")
    return ros.rcl_interfaces__msg__Log(_time(tick), LEVELS[severity], name, text, "", "", 0)


def _image(pixels: Pixels, encoding: str, tick: int) -> Any:
    height, width, channels = pixels.shape
    header = ros.std_msgs__msg__Header(_time(tick), "")
    step = width * channels
    return ros.sensor_msgs__msg__Image(header, height, width, encoding, 0, step, pixels.reshape(-1))


def _time(tick: int) -> Any:
    return ros.builtin_interfaces__msg__Time(*divmod(tick * TICK_NS, 1_000_000_000))


# Messages to a recording ----------------------------------------------------------------------


def contents(found: Sequence[Item], turtles: Sequence[str]) -> Contents:
    """What messages in order say; `turtles` are those that publish, in order.

    Raises:
        ValueError, KeyError, TypeError, AttributeError: they are not what `items` makes.
    """
    events: list[dict[str, Any]] = []
    logs: list[list[Any]] = []
    pictures: dict[str, Pixels] = {}
    readings: dict[str, list[tuple[float, ...]]] = defaultdict(list)
    for tick, topic, msgtype, message in found:
        match msgtype:
            case "turtlesim/msg/Pose":
                readings[topic].append((tick, *_POSE_FIELDS(message)))
            case "turtlesim/msg/Color":
                readings[topic].append((tick, message.r, message.g, message.b))
            case "geometry_msgs/msg/Twist":
                events.append(_command(tick, topic, message))
            case "std_msgs/msg/String":
                events.append(_event(message.data))
            case "rcl_interfaces/msg/Log":
                logs.append([tick, SEVERITIES[message.level], message.name, message.msg])
            case "sensor_msgs/msg/Image":
                pictures[topic] = _pixels(message, ENCODINGS[topic])
            case _:
                raise ValueError(f"a recording has no {msgtype} on {topic}")
    published = {name: _rows(*(readings[topic] for topic in topics(name))) for name in turtles}
    return Contents(tuple(events), published, tuple(logs), pictures[PATH], pictures[WINDOW])


def _command(tick: int, topic: str, twist: Any) -> dict[str, Any]:
    """The scenario event of a Twist, as the recorder writes it."""
    vectors = {
        key: [number(value, 17) for value in (vector.x, vector.y, vector.z)]
        for key, vector in (("linear", twist.linear), ("angular", twist.angular))
    }
    turtle = topic.removeprefix("/").removesuffix("/cmd_vel")
    return {"tick": tick, "op": "cmd_vel", "turtle": turtle, **vectors}


def _event(text: str) -> dict[str, Any]:
    event = json.loads(text)
    if not isinstance(event["tick"], int) or not isinstance(event["op"], str):
        raise ValueError(f"an event needs 'tick' and 'op', found {text:.80}")
    return dict(event)


def _rows(poses: list[tuple[float, ...]], colors: list[tuple[float, ...]]) -> Rows:
    left = np.array(poses, dtype=np.float64).reshape(-1, 6)
    right = np.array(colors, dtype=np.float64).reshape(-1, 4)
    if not np.array_equal(left[:, 0], right[:, 0]):
        raise ValueError(f"{len(left)} poses and {len(right)} colours do not belong together")
    return np.hstack([left, right[:, 1:]])


def _pixels(image: Any, encoding: str) -> Pixels:
    if image.encoding != encoding:
        raise ValueError(f"a picture has the encoding {image.encoding!r}, expected {encoding!r}")
    pixels: Pixels = image.data.reshape(image.height, image.width, len(encoding) - 1)
    return pixels
