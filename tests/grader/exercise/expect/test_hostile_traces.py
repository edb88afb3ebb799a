"""Every expectation comes to an end, with a finding, whatever was exchanged."""

import json
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.conftest import CASES
from tests.grader.exercise.expect.traces import (
    endpoint,
    event,
    judged,
    line,
    number,
    text,
    transform,
)

EXPECTED: dict[str, dict[str, Any]] = {
    "node": {"node": "node"},
    "values": {"topic": "out", "values": "=heard['/data'][-1].data / message.data + n"},
    "range": {"topic": "out", "values": {"at_least": "=heard['/data'][0].data", "at_most": 5}},
    "text": {"topic": "text", "values": "/^{heard['/text'][-1].data}{1,3}$/"},
    "rate": {"topic": "out", "rate": {"hz": 3}, "qos": {"depth": 1, "durability": "volatile"}},
    "log": {"log": "{data:.2f}", "each": "out", "level": "info"},
    "pattern": {"log": "/^{data}?$/", "each": "text"},
    "heard": {"log": "I heard {message.data}", "heard": "data"},
    "lines": {"log": "/a+/", "count": {"at_least": 2, "at_most": 3}},
    "call": {"call": "id", "response": {"sum": "=a + b", "data": "{request.a:d}"}},
    "served": {"served": "add", "request": {"a": 2, "b": [1]}},
    "goal": {
        "goal": "id",
        "result": "=range(order)",
        "feedback": [["=order"]],
        "status": "aborted",
    },
    "refused": {"goal": "id", "accepted": False},
    "sends": {"sends": "fib", "values": {"order": {"at_least": 3}}},
    "parameter": {"parameter": "id", "values": {"p": 1, "q": "/x/"}, "set": {"p": True}},
    "transform": {
        **{"transform": "child", "parent": "world", "rotation": {"w": 1}},
        "translation": {"x": "=heard['/data'][-1].data"},
    },
    "got": {"got": "out", "by": "peer"},
    "exits": {"exits": 0},
}
times = st.floats(0, 9)
numbers = st.floats() | st.sampled_from([0.0, 1e308, -1.0, 2.0**63, 5e-324])
texts = st.sampled_from(
    ["", "a", "aa", "/.*/", "/(/", "{n}", "=1/0", "\x1b[2J", "a" * 3000, "\u202e"]
)
nodes = st.sampled_from(["/node", "/peer", ""])
plain = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**63), 2**64) | st.floats(allow_nan=False)
    | st.sampled_from(["nan", "inf", "", "a" * 300]),
    lambda inner: st.lists(inner) | st.dictionaries(st.sampled_from("abxy"), inner),
    max_leaves=6,
)  # fmt: skip
objects = st.dictionaries(
    st.sampled_from(["a", "b", "sum", "order", "data", "request", "n"]), plain, max_size=4
)
moments = st.integers(0, 10**10)
endpoints = st.builds(
    endpoint,
    st.sampled_from(
        ["topic /out", "topic /text", "topic /data", "request /add", "topic /" + "x" * 300]
    ),
    st.sampled_from(["std_msgs/msg/Float64", "std_msgs/msg/String", "x/msg/X"]),
    writes=st.booleans(),
    reliability=st.integers(0, 2**32 - 1),
    durability=st.integers(0, 2**32 - 1),
    depth=st.integers(0, 2**32 - 1),
    node=nodes,
)


def happened(kind: str, always: dict[str, Any], later: dict[str, Any]) -> st.SearchStrategy[Any]:
    """An event, of which what comes later may not have come."""
    given_ = {name: st.just(value) for name, value in always.items() if isinstance(value, str)}
    others = {name: made for name, made in always.items() if not isinstance(made, str)}
    return st.fixed_dictionaries({**given_, **others}, optional=later).map(
        lambda values: event(kind, **values)
    )


asked = {"request": objects, "sent_ns": moments}
events = st.one_of(
    happened("call", {"id": "id", "service": "/add", "type": "t", **asked},
             {"response": objects, "answered_ns": moments}).filter(
                 lambda each: ("response" in each) == ("answered_ns" in each)),
    happened("call", {"id": "id", "service": "/add", "type": "t"}, {}),
    happened("served", {"service": "/add", "request": objects}, {"response": objects}),
    happened("goal", {"id": "id", "action": "/fib", "type": "t", "goal": objects,
                      "sent_ns": moments, "feedback": st.lists(st.tuples(moments, objects))},
             {"accepted": st.booleans(), "status": st.sampled_from(["succeeded", "unknown"]),
              "result": objects, "ended_ns": moments}),
    happened("action", {"action": "/fib", "goal": objects, "accepted": st.booleans()}, {}),
    happened("parameter", {"id": "id", "node": "/node"}, {}),
    happened("parameter", {"id": "id", "node": "/node", "answered_ns": moments},
             {"values": st.dictionaries(st.sampled_from("pq"), plain),
              "set": st.dictionaries(st.sampled_from("pq"), texts)}),
    happened("got", {"topic": "/out", "values": objects}, {}),
    happened("refused", {"what": "x", "why": texts}, {}),
    happened("full", {}, {}),
)  # fmt: skip
messages = st.one_of(
    st.builds(number, times, st.sampled_from(["/out", "/data"]), numbers, node=nodes),
    st.builds(text, times, st.just("/text"), texts, node=nodes),
    st.builds(line, times, texts, level=st.integers(0, 255)),
    st.builds(transform, times, texts, st.just("child"), *[numbers] * 7),
    st.builds(transform, times, st.just("world"), st.just("child"), *[numbers] * 7),
)


@pytest.mark.parametrize("name", EXPECTED)
@settings(max_examples=CASES // 2)
@given(parts=st.lists(endpoints | events | messages, max_size=12), code=st.none() | st.just(0))
def test_an_expectation_ends_with_a_finding(name, parts, code):
    found = judged(EXPECTED[name], *parts, code=code)
    assert found.share in (0, 0.5, 1)
    for sentence in (found.rationale, found.help):
        assert len(str(sentence)) < 3_000
        assert not any(ord(each) < 32 for each in str(sentence))
        json.dumps(sentence.serialise())
