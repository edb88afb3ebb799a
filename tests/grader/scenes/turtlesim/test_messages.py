"""Messages and traces mean the same; what other people's bags hold is no trace."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from grader.recording.mcap import Channel
from grader.recording.subject import BagMessage
from grader.ros.bag_types import OF_ROS
from grader.ros.cdr import string
from grader.scenes.turtlesim import messages
from grader.scenes.turtlesim.scene import SCENE
from grader.scenes.turtlesim.trace import TurtleTrace
from tests.grader.driving import Spiral, drive
from tests.grader.recording.slow_bag import types_of
from tests.grader.scenes.turtlesim.traces import assert_same_trace, odd_traces
from turtlesim_py.world.arena import TICK_NS


@pytest.fixture(scope="module")
def trace():
    return TurtleTrace.of(drive(Spiral(), ticks=100).trace)


def channels_of(found, trace):
    """Messages as the columns of a bag; also the topics that have none."""
    topics = dict(SCENE.bag_topics(trace)) | {m.topic: m.msgtype for m in found}
    cdr = [m.data for m in found]
    ends = np.cumsum([len(data) for data in cdr])
    begins, times_ns = ends - [len(data) for data in cdr], np.array([m.time_ns for m in found])
    made = []
    for topic, msgtype in topics.items():
        own = np.array([n for n, m in enumerate(found) if m.topic == topic], np.int64)
        data = np.frombuffer(b"".join(cdr), np.uint8)
        made.append(Channel(topic, msgtype, times_ns[own], own, data, begins[own], ends[own]))
    return made


def said(text):
    return BagMessage(TICK_NS, "/turtlesim/events", "std_msgs/msg/String", string(text))


@given(odd=odd_traces())
def test_a_trace_comes_back_from_its_messages_bit_for_bit(odd):
    back = messages.from_channels(channels_of(messages.to_messages(odd), odd), odd.ticks)
    assert_same_trace(back, odd)


@given(odd=odd_traces())
def test_its_bytes_are_what_rosbags_serializes(odd):
    types = types_of(OF_ROS)
    for packed in messages.to_messages(odd):
        message = types.deserialize_cdr(packed.data, packed.msgtype)
        data = types.serialize_cdr(message, packed.msgtype, little_endian=True)
        assert packed.data == bytes(data)


def test_a_turtle_that_published_nothing_has_topics_all_the_same(trace):
    made = replace(trace, trajectories={"a/b": trace.trajectory("nobody")})
    assert dict(SCENE.bag_topics(made)) == {
        "/a/b/pose": "turtlesim/msg/Pose",
        "/a/b/color_sensor": "turtlesim/msg/Color",
    }


def test_the_messages_stand_by_time(trace):
    times_ns = [message.time_ns for message in messages.to_messages(trace)]
    assert times_ns == sorted(times_ns)
    assert times_ns[-1] <= trace.duration_ns == 1_600_000_000  # of 100 ticks


@pytest.mark.parametrize(
    "strange",
    [
        said("hello"),
        said("[]"),
        said("{}"),
        said('{"tick": "1", "op": "clear"}'),
        said('{"tick": 1, "op": "kill"}'),
        BagMessage(TICK_NS, "/chatter", "std_msgs/msg/Int8", b"\0\1\0\0\1"),
        BagMessage(TICK_NS, "/turtle1/cmd_vel", "geometry_msgs/msg/Twist", b"\0\1\0\0" + bytes(40)),
        BagMessage(TICK_NS, "/turtle1/cmd_vel", "geometry_msgs/msg/Twist", b"\0\0\0\0" + bytes(48)),
        BagMessage(TICK_NS, "/turtle1/color", "turtlesim/msg/Color", b"\0\1\0\0" + bytes(3)),
        BagMessage(TICK_NS, "/a/picture", "sensor_msgs/msg/Image", b"\0\1\0\0"),
    ],
)
def test_what_no_trace_says_is_refused(trace, strange):
    found = [strange, *messages.to_messages(trace)]
    with pytest.raises(ValueError):
        messages.from_channels(channels_of(found, trace), trace.ticks)


def test_a_pose_without_its_colour_is_refused(trace):
    found = messages.to_messages(trace)
    last = max(n for n, message in enumerate(found) if message.msgtype == messages.COLOR)
    with pytest.raises(ValueError, match="100 poses and 99 colours do not belong together"):
        messages.from_channels(channels_of(found[:last] + found[last + 1 :], trace), trace.ticks)


def test_one_picture_of_each_kind_is_expected_in_its_encoding(trace):
    found = messages.to_messages(trace)
    with pytest.raises(ValueError, match="expected one sensor_msgs/msg/Image, found 2"):
        messages.from_channels(channels_of([*found, found[-1]], trace), trace.ticks)
    for topic in ("/turtlesim/path", "/turtlesim/window"):
        others = [message for message in found if message.topic != topic]
        with pytest.raises(KeyError, match=topic):
            messages.from_channels(channels_of(others, trace), trace.ticks)
    found[-1] = found[-1]._replace(data=found[-1].data.replace(b"rgb8", b"mono"))
    with pytest.raises(ValueError, match="'mono', expected 'rgb8'"):
        messages.from_channels(channels_of(found, trace), trace.ticks)
