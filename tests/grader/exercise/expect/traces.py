"""Traces of casts for tests, written by hand; `/peer` is the one peer."""

from typing import Any

from grader.cast.trace import CastTrace, SentMessage
from grader.exercise.expect import judging
from grader.exercise.expect.expectations import parse
from grader.exercise.verdict import Finding
from grader.recording.recording import Recording, Recordings, Run
from grader.scenes.scene import STEP_NS
from tests.grader.recording.slow_bag import types_of

DEFINITIONS = {
    "std_msgs/msg/String": "string data",
    "std_msgs/msg/Float64": "float64 data",
    "rcl_interfaces/msg/Log": "uint8 level\nstring msg",
    "std_msgs/msg/Header": "string frame_id",
    "geometry_msgs/msg/Vector3": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/msg/Quaternion": "float64 x\nfloat64 y\nfloat64 z\nfloat64 w",
    "geometry_msgs/msg/Transform": "Vector3 translation\nQuaternion rotation",
    "geometry_msgs/msg/TransformStamped": (
        "std_msgs/Header header\nstring child_frame_id\nTransform transform"
    ),
    "tf2_msgs/msg/TFMessage": "geometry_msgs/TransformStamped[] transforms",
}
TYPES = types_of(DEFINITIONS)
TICKS_A_S = 1_000_000_000 / STEP_NS


def sent(at_s: float, topic: str, kind: str, *values: Any, node: str = "/node") -> SentMessage:
    """Make a message with these values of its fields."""
    message = TYPES.types[kind](*values)
    return SentMessage(
        round(at_s * 1e9), topic, kind, node, bytes(TYPES.serialize_cdr(message, kind))
    )


def text(at_s: float, topic: str, value: str, **more: Any) -> SentMessage:
    return sent(at_s, topic, "std_msgs/msg/String", value, **more)


def number(at_s: float, topic: str, value: float, **more: Any) -> SentMessage:
    return sent(at_s, topic, "std_msgs/msg/Float64", value, **more)


def line(at_s: float, value: str, level: int = 20) -> SentMessage:
    return sent(at_s, "/rosout", "rcl_interfaces/msg/Log", level, value)


def transform(
    at_s: float, parent: str, child: str, *numbers: float, topic: str = "/tf"
) -> SentMessage:
    """A transform by x, y, z and a quaternion."""
    made = TYPES.types
    move = made["geometry_msgs/msg/Vector3"](*numbers[:3])
    turn = made["geometry_msgs/msg/Quaternion"](*numbers[3:])
    each = made["geometry_msgs/msg/TransformStamped"](
        made["std_msgs/msg/Header"](parent), child, made["geometry_msgs/msg/Transform"](move, turn)
    )
    return sent(at_s, topic, "tf2_msgs/msg/TFMessage", [each])


def endpoint(
    channel: str, kind: str = "std_msgs/msg/String", *, writes: bool = True, **more: Any
) -> Any:
    values = {"reliability": 1, "durability": 2, "depth": 10, "node": "/node", "time_ns": 0}
    made = {"kind": "endpoint", "channel": channel, "type": kind, "writes": writes}
    return {**made, **values, **more}


def event(kind: str, **values: Any) -> Any:
    return {"kind": kind, "time_ns": 1_000_000_000, "peer": "/peer", **values}


def trace(*parts: Any, length_s: float = 10) -> CastTrace:
    """A trace of messages and events."""
    messages = sorted(
        (p for p in parts if isinstance(p, SentMessage)), key=lambda each: each.time_ns
    )
    events = tuple(p for p in parts if isinstance(p, dict))
    ticks = round(length_s * TICKS_A_S)
    return CastTrace(ticks, tuple(messages), events, ("/peer",), DEFINITIONS)


def judged(
    expected: dict[str, Any],
    *parts: Any,
    output: str = "",
    code: int | None = 0,
    length_s: float = 10,
) -> Finding:
    """The finding on what is expected of a trace with these parts."""
    run = Run("virtual", exit_code=code)
    recording = Recording(trace(*parts, length_s=length_s), run, output=output, scene="graph")
    return judging.judge(parse(expected, ("expect", "it")), Recordings(recording))
