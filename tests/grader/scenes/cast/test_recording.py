"""What is exchanged is recorded within bounds, under the right names, and is the same in a bag."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.rosbag2 import Reader
from std_msgs.msg import Float64, String

from grader.recording import bag
from grader.recording.mcap import Channel
from grader.ros.cdr import string
from grader.ros.messages import plain, serialise
from grader.run.lockstep.protocol import EndpointInfo
from grader.scenes.cast import recorder
from grader.scenes.cast.recorder import CastRecorder, Types
from grader.scenes.cast.trace import EVENTS, CastTrace, from_channels
from grader.scenes.subject import load_subject

STRING = "std_msgs/msg/String"
TALKS = EndpointInfo("/node", "topic /chatter", STRING, True)


class Heard:
    """A recorder, with its clock and what it asks to hear."""

    def __init__(self):
        self.now_ns = 0
        self.taps = []
        more = (["/chatter", "/data", "/cast/events"], ["/peer"], lambda: self.now_ns)
        self.recorder = CastRecorder(
            Types({}), *more, lambda name, kind, _: self.taps.append((name, kind))
        )

    def hear(self, data, topic="/chatter", kind=STRING):
        message = String(data=data) if kind == STRING else Float64(data=float(data))
        self.recorder.heard(topic, kind, self.now_ns, serialise(message))

    def trace(self):
        return self.recorder.trace(625, ["/peer"])


@pytest.fixture
def heard():
    return Heard()


def test_what_is_named_is_heard_and_nothing_else(heard):
    other = TALKS._replace(channel="topic /other")
    served = TALKS._replace(channel="request /chatter", type="std_srvs/srv/Trigger")
    heard.recorder.meet([TALKS, other, served, TALKS._replace(writes=False)])
    heard.recorder.meet([TALKS])
    assert len(heard.trace().of_kind("endpoint")) == 4
    heard.recorder.meet([TALKS._replace(channel="topic /cast/events")])  # our own
    assert heard.taps == [("/chatter", STRING)]


@pytest.mark.parametrize(
    "kind",
    [
        *("antigravity/msg/Foo", "grader/scenes/cast/Foo", "os/path/Foo", "std_msgs/msg/Strin"),
        *("std_msgs/__init__/String", "example_interfaces/action/Fibonacci_FeedbackMessage"),
        "std_srvs/srv/Trigger_Request",
    ],
)
def test_a_type_that_is_none_of_ros_is_neither_imported_nor_heard(heard, kind, monkeypatch):
    def refuse(*_):
        raise AssertionError("a browser was opened")

    monkeypatch.setattr("webbrowser.open", refuse)
    heard.recorder.meet([TALKS._replace(type=kind)])
    assert heard.taps == []


def test_a_sender_is_known_where_only_one_node_can_be_it(heard):
    heard.recorder.meet([TALKS])
    heard.hear("one")
    heard.recorder.meet([TALKS, TALKS._replace(node="/other")])
    heard.hear("two")
    assert [message.node for message in heard.trace().messages] == ["/node", ""]


def test_of_several_programs_the_sender_is_known_by_its_link(heard):
    heard.recorder.meet([TALKS._replace(id=1), TALKS._replace(node="/other", id=2)])
    for program in (1, 2):
        heard.recorder.heard("/chatter", STRING, 0, serialise(String(data="said")), program)
    trace = heard.recorder.trace(625, (), {1: "talker-1", 2: "other-2"})
    assert [message.node for message in trace.messages] == ["/node", "/other"]
    assert trace.programs == {"/node": "talker-1", "/other": "other-2"}


def test_a_program_that_is_called_like_a_peer_is_none(heard):
    heard.recorder.meet([TALKS._replace(node="/peer")])
    heard.hear("forged")
    heard.recorder.said("/chatter", STRING, "/peer", String(data="said"))
    trace = heard.trace()
    assert [trace.values(each)["data"] for each in trace.sent("/chatter")] == ["forged"]
    assert [trace.values(each)["data"] for each in trace.sent("/chatter", by_peers=True)] == [
        "said"
    ]


def test_a_topic_has_the_type_of_its_first_message(heard):
    heard.hear("one")
    heard.hear("2", kind="std_msgs/msg/Float64")
    heard.recorder.said("/chatter", "std_msgs/msg/Float64", "/peer", Float64(data=3.0))
    assert [message.type for message in heard.trace().messages] == [STRING]


def test_what_is_no_message_is_not_recorded(heard):
    for data in (b"", b"\0\1\0\0", b"\0\1\0\0\xff\xff\xff\xff", b"\0\0\0\0\0\0\0\0"):
        heard.recorder.heard("/chatter", STRING, 0, data)
    assert heard.trace().messages == ()


def test_messages_are_recorded_up_to_a_number(heard, monkeypatch):
    monkeypatch.setattr(recorder, "MOST_MESSAGES", 3)
    for heard.now_ns in range(9):
        heard.hear("x")
    trace = heard.trace()
    assert len(trace.messages) == 3
    # said once, with the time from which on anything may be missing
    assert [event["time_ns"] for event in trace.of_kind("full")] == [3]
    assert [str(flag) for flag in heard.recorder.flags] == [
        "of what was exchanged, the first 3 messages and 20,000,000 bytes were recorded"
    ]


def test_messages_and_events_are_recorded_up_to_so_many_bytes(heard, monkeypatch):
    monkeypatch.setattr(recorder, "MOST_BYTES", 3_000)
    heard.hear("x" * 2_000)
    heard.hear("y" * 2_000)
    heard.hear("small, and too late")
    assert len(heard.trace().messages) == 1
    assert heard.trace().of_kind("full")
    other = Heard()
    assert other.recorder.plain(String(data="x" * 2_000)) == {"data": "x" * 2_000}
    assert other.recorder.plain(String(data="x" * 2_000)) == {}
    assert other.recorder.is_full


def test_events_are_recorded_up_to_a_number(heard, monkeypatch):
    monkeypatch.setattr(recorder, "MOST_EVENTS", 3)
    heard.recorder.meet([TALKS._replace(node=f"/n{n}") for n in range(9)])
    assert [event["kind"] for event in heard.trace().events] == ["endpoint"] * 3 + ["full"]


@pytest.fixture
def trace(heard):
    """A trace of messages of a program and a peer, some at the same time."""
    heard.recorder.meet([TALKS])
    for heard.now_ns in (0, 5_000_000, 5_000_000, 2_000_000_000):
        heard.hear(f"at {heard.now_ns}: \x1b[2J é \U0001f600")
        heard.recorder.said("/data", "std_msgs/msg/Float64", "/peer", Float64(data=float("nan")))
        heard.recorder.event(
            "got", peer="/peer", topic="/data", values=plain(Float64(data=float("inf")))
        )
    return heard.trace()


def written(trace, folder):
    return bag.write(trace, load_subject("graph"), folder / "recording")


def test_a_trace_is_the_same_after_a_bag_even_an_empty_one(trace, tmp_path):
    for each in (trace, CastTrace(625, peers=("/peer",))):
        place = tmp_path / str(len(each.messages))
        again = bag.read(written(each, place), load_subject("graph"), each.duration_ns)
        assert again == each
        assert again.sha256() == each.sha256()


def test_a_bag_holds_the_real_topics(trace, tmp_path):
    mcap = written(trace, tmp_path)
    with Reader(mcap.parent) as reader:
        found = {each.topic: (each.msgtype, each.msgcount) for each in reader.connections}
    assert found["/chatter"] == (STRING, 4)
    assert found["/data"] == ("std_msgs/msg/Float64", 4)
    with mcap.open("rb") as file:
        decoded = make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages()
        said = [(each.log_time, message.data) for _, channel, each, message in decoded
                if channel.topic == "/chatter"]  # fmt: skip
    assert said[0] == (0, "at 0: \x1b[2J é \U0001f600")
    assert [time_ns for time_ns, _ in said] == [0, 5_000_000, 5_000_000, 2_000_000_000]


def test_the_hash_is_of_what_was_exchanged(trace):
    first = trace.messages[0]
    others = [
        replace(trace, ticks=1),
        replace(trace, peers=()),
        replace(trace, events=trace.events[1:]),
        replace(trace, messages=trace.messages[1:]),
        replace(trace, messages=(first._replace(node=""), *trace.messages[1:])),
        replace(trace, messages=(first._replace(time_ns=1), *trace.messages[1:])),
    ]
    assert len({each.sha256() for each in (trace, *others)}) == len(others) + 1
    assert replace(trace, definitions={}).sha256() == trace.sha256()


@pytest.mark.parametrize("event", ["5", "[]", "{}", '{"kind": 5, "time_ns": 1}', "nan"])
def test_what_is_no_event_makes_no_trace(event):
    last = '{"definitions": {}, "topics": [], "nodes": [], "order": [], "peers": []}'
    data = [string(event), string(last)]
    ends = np.cumsum([len(each) for each in data])
    places = (np.array([0, 1]), np.array([0, 1]), np.frombuffer(b"".join(data), np.uint8))
    channel = Channel(EVENTS, STRING, *places, ends - [len(each) for each in data], ends)
    with pytest.raises((ValueError, KeyError, TypeError)):
        from_channels([channel], 10**9)
