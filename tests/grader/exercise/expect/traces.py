"""Traces of casts for tests, written by hand; `/peer` is the one peer."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from grader.exercise.expect import judging
from grader.exercise.expect.expectations import parse
from grader.exercise.verdict import Finding
from grader.recording.recording import Clock, OwnInterfaces, Recording, Recordings, Run
from grader.ros.bag_types import BagTypes
from grader.scenes.cast.trace import CastTrace, SentMessage
from grader.scenes.scene import STEP_NS

TYPES, NOW = BagTypes({}), {"sec": 0, "nanosec": 0}
TICKS_A_S = 1_000_000_000 / STEP_NS


def sent(at_s: float, topic: str, kind: str, *, node: str = "/node", **values: Any) -> SentMessage:
    """Make a message with these values of its fields."""
    return SentMessage(round(at_s * 1e9), topic, kind, node, TYPES.data(kind, values))


def text(at_s: float, topic: str, value: str, **more: Any) -> SentMessage:
    return sent(at_s, topic, "std_msgs/msg/String", data=value, **more)


def number(at_s: float, topic: str, value: float, **more: Any) -> SentMessage:
    return sent(at_s, topic, "std_msgs/msg/Float64", data=value, **more)


def line(at_s: float, value: str, level: int = 20, name: str = "") -> SentMessage:
    values = {"stamp": NOW, "name": name, "file": "", "function": "", "line": 0}
    return sent(at_s, "/rosout", "rcl_interfaces/msg/Log", level=level, msg=value, **values)


def transform(
    at_s: float, parent: str, child: str, *numbers: float, topic: str = "/tf"
) -> SentMessage:
    """A transform by x, y, z and a quaternion."""
    move = dict(zip("xyz", numbers[:3], strict=True))
    turn = dict(zip("xyzw", numbers[3:], strict=True))
    header, moved = {"stamp": NOW, "frame_id": parent}, {"translation": move, "rotation": turn}
    each = {"header": header, "child_frame_id": child, "transform": moved}
    return sent(at_s, topic, "tf2_msgs/msg/TFMessage", transforms=[each])


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
    return CastTrace(ticks, tuple(messages), events, ("/peer",))


def judged(
    expected: dict[str, Any],
    *parts: Any,
    output: str = "",
    code: int | None = 0,
    length_s: float = 10,
    time: Clock = "virtual",
    programs: Mapping[str, str] | None = None,
    own: Mapping[str, str] | None = None,
) -> Finding:
    """The finding on what is expected of a trace with these parts, and with types of its own."""
    run, interfaces = Run(time, exit_code=code), OwnInterfaces(own or {})
    whole = replace(trace(*parts, length_s=length_s), programs=programs or {})
    recording = Recording(whole, run, output=output, scene="graph", interfaces=interfaces)
    wanted = parse(expected, ("expect", "it"))
    return judging.judge(lambda _: wanted, Recordings(recording))
