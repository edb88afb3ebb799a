"""Traces of odd nodes, which the checks of an exercise with a cast have to survive."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from grader.ros.bag_types import BagTypes
from grader.ros.cdr import string
from grader.scenes.cast.trace import ROSOUT, CastTrace, SentMessage

TICKS = 300
_STRING, _FLOAT, _LOG = "std_msgs/msg/String", "std_msgs/msg/Float64", "rcl_interfaces/msg/Log"
_TYPES = BagTypes({})
_ENDPOINT = {"type": _STRING, "reliability": 1, "durability": 2, "depth": 10}


def odd_traces() -> Mapping[str, CastTrace]:
    """Return the traces, by what their nodes do."""
    long = "x" * 20_000
    names = ("/topic", "/tf", "/latest", "/turtle1/cmd_vel")
    writers = [_endpoint("/node", f"topic {name}") for name in names]
    return {
        "nothing at all": CastTrace(),
        "a node that does nothing": _trace(_endpoint("/node", "topic /parameter_events")),
        "a thousand nodes": _trace(*(_endpoint(f"/n{n}", "topic /x") for n in range(1000))),
        "a node with a very long name": _trace(_endpoint(f"/{long[:600]}", f"topic /{long[:300]}")),
        "odd qualities of service": _trace(_endpoint("/node", "topic /latest", depth=2**32 - 1)),
        "texts where something else belongs": _trace(*writers, sent=[
            SentMessage(10**9, name, _STRING, "/node", string("\x1b[2J \ud800")) for name in names
        ]),
        "numbers that are none": _trace(*writers, sent=[
            SentMessage(10**8 * n, name, _FLOAT, "/node", _TYPES.data(_FLOAT, {"data": value}))
            for n, value in enumerate((float("nan"), float("inf"), -1e308, 0.0))
            for name in names
        ]),
        "log lines of no level": _trace(sent=[
            SentMessage(10**9 + n, ROSOUT, _LOG, "", _log(n * 17 % 256, text))
            for n, text in enumerate(("", long, "\n\r\t", "Hello World: 0"))
        ]),
        "everything at once": _trace(*writers, sent=[
            SentMessage(0, "/topic", _STRING, "/node", string("Hello World: 0")) for _ in range(50)
        ]),
        "peers that could do nothing": _trace(
            {"kind": "refused", "time_ns": 0, "peer": "/peer", "what": "x", "why": "y"}
        ),
        "more than is recorded": _trace({"kind": "full", "time_ns": 10**9}),
        "a message that nobody sent": _trace(sent=[
            SentMessage(2 * 10**9, "/topic", _STRING, "", string("?"))
        ]),
    }  # fmt: skip


def _trace(*events: Mapping[str, Any], sent: list[SentMessage] | None = None) -> CastTrace:
    messages = tuple(sorted(sent or [], key=lambda each: each.time_ns))
    return CastTrace(TICKS, messages, events, ("/peer",))


def _endpoint(node: str, channel: str, **more: Any) -> dict[str, Any]:
    facts = {"kind": "endpoint", "time_ns": 0, "node": node, "channel": channel, "writes": True}
    return {**facts, **_ENDPOINT, **more}


def _log(level: int, text: str) -> bytes:
    line = {"stamp": {"sec": 1, "nanosec": 0}, "level": level, "name": "node", "msg": text}
    return _TYPES.data(_LOG, {**line, "file": "", "function": "", "line": 1})
