"""tf2_ros in nodes: what is sent and heard over DDS, and how a buffer waits and forgets.

Where ROS is sourced this looks at ROS's own.
"""

import asyncio
import importlib
import os

import pytest
import rclpy
import tf2_ros
from geometry_msgs.msg import PointStamped, TransformStamped
from rclpy.clock import ClockType
from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.time import Time
from tf2_msgs.msg import TFMessage
from tf2_msgs.srv import FrameGraph
from tf2_ros import (
    Buffer,
    ConnectivityException,
    LookupException,
    StaticTransformBroadcaster,
    TransformBroadcaster,
    TransformListener,
)

from tests.graph import wait_for_arrival
from tests.programs import Program

from .transforms import at, stamp_s, transform, xyz

OURS = "ROS_DISTRO" not in os.environ
LATEST = Time()


@pytest.fixture
def node(ros):
    node = rclpy.create_node("robot", use_global_arguments=False)
    yield node
    node.destroy_node()


@pytest.fixture
def buffer():
    return Buffer()


def give(buffer: Buffer, *transforms: TransformStamped) -> None:
    for one in transforms:
        buffer.set_transform(one, "a test")


# what programs import


#: Module -> what tutorials and students import from it.
IMPORTED = {
    "tf2_ros": [
        *("TransformBroadcaster", "StaticTransformBroadcaster", "TransformListener", "Buffer"),
        *("BufferInterface", "BufferCore", "TransformException", "LookupException"),
        *("ConnectivityException", "ExtrapolationException", "InvalidArgumentException"),
        *("TimeoutException", "TypeException", "TransformRegistration", "ConvertRegistration"),
        *("convert", "Stamped", "TransformStamped", "TFMessage", "QoSProfile", "Duration"),
        *("Time", "Node", "rclpy", "tf2", "buffer", "buffer_interface", "transform_listener"),
        *("transform_broadcaster", "static_transform_broadcaster"),
    ],
    "tf2_ros.buffer": ["Buffer"],
    "tf2_ros.buffer_interface": ["BufferInterface", "TransformRegistration", "TypeException"],
    "tf2_ros.transform_broadcaster": ["TransformBroadcaster", "TFMessage", "TransformStamped"],
    "tf2_ros.static_transform_broadcaster": ["StaticTransformBroadcaster", "TFMessage"],
    "tf2_ros.transform_listener": ["TransformListener", "TFMessage"],
    "tf2_msgs.msg": ["TFMessage", "TF2Error"],
    "tf2_msgs.srv": ["FrameGraph"],
}


@pytest.mark.parametrize("module", IMPORTED)
def test_what_programs_import_is_there(module):
    found = dir(importlib.import_module(module))
    assert [name for name in IMPORTED[module] if name not in found] == []


def test_the_exceptions_are_those_of_tf2_py():
    import tf2_py

    names = [name for name in dir(tf2_py) if name.endswith("Exception")]
    assert len(names) == 6
    assert all(getattr(tf2_ros, name) is getattr(tf2_py, name) for name in names)


# what is on the network


@pytest.mark.parametrize(
    ("kind", "given", "topic", "depth", "durability"),
    [
        (TransformBroadcaster, [], "/tf", 100, DurabilityPolicy.VOLATILE),
        (TransformBroadcaster, [QoSProfile(depth=7)], "/tf", 7, DurabilityPolicy.VOLATILE),
        (TransformBroadcaster, [5], "/tf", 5, DurabilityPolicy.VOLATILE),
        (StaticTransformBroadcaster, [], "/tf_static", 1, DurabilityPolicy.TRANSIENT_LOCAL),
        (StaticTransformBroadcaster, [3], "/tf_static", 3, DurabilityPolicy.VOLATILE),
    ],
)
def test_broadcasters_have_the_originals_quality_of_service(
    ros, kind, given, topic, depth, durability
):
    node = rclpy.create_node("robot", namespace="/deep", use_global_arguments=False)
    publisher = kind(node, *given).pub_tf
    assert publisher.topic_name == topic  # whatever the namespace
    qos = publisher.qos_profile
    found = (qos.depth, qos.durability, qos.reliability, qos.history)
    assert found == (depth, durability, ReliabilityPolicy.RELIABLE, HistoryPolicy.KEEP_LAST)
    node.destroy_node()


def test_a_listener_has_the_originals_quality_of_service_and_takes_another(node, buffer):
    listener = TransformListener(buffer, node)
    moving, static = listener.tf_sub, listener.tf_static_sub
    assert (moving.topic_name, static.topic_name) == ("/tf", "/tf_static")
    assert (moving.qos_profile.depth, static.qos_profile.depth) == (100, 100)
    assert moving.qos_profile.durability == DurabilityPolicy.VOLATILE
    assert static.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
    assert moving.callback_group is static.callback_group
    assert type(moving.callback_group).__name__ == "ReentrantCallbackGroup"
    other = TransformListener(buffer, node, qos=5, static_qos=6)
    assert (other.tf_sub.qos_profile.depth, other.tf_static_sub.qos_profile.depth) == (5, 6)
    for each in (listener, other):  # who is gone does not listen
        each.unregister()
    assert list(node.subscriptions) == []


def test_one_several_or_any_number_of_transforms_are_one_message(graph, node):
    broadcaster = TransformBroadcaster(node)
    heard = graph.listen(TFMessage, "/tf")
    pair = [transform("a", "b", 1), transform("a", "c", 1)]
    for sent in (pair[0], pair, tuple(pair), (one for one in pair), []):
        broadcaster.sendTransform(sent)
    graph.until(lambda: len(heard) == 5, "five messages")
    assert [message.transforms for message in heard] == [pair[:1], pair, pair, pair, []]


def test_the_static_broadcaster_sends_all_it_has_sent_again(graph, node):
    broadcaster = StaticTransformBroadcaster(node)
    heard = graph.listen(TFMessage, "/tf_static")
    first, second = transform("a", "b", 1), transform("a", "c", 2)
    for sent in (first, [second], []):
        broadcaster.sendTransform(sent)
    graph.until(lambda: len(heard) == 3, "three messages")
    assert [message.transforms for message in heard] == [[first], [first, second], [first, second]]


@pytest.mark.applies(OURS, reason="from some release on it replaces the first")
def test_the_static_broadcaster_keeps_the_first_transform_of_a_frame_and_that_very_object(
    graph, node
):
    broadcaster = StaticTransformBroadcaster(node)
    heard = graph.listen(TFMessage, "/tf_static")
    first = transform("a", "b", 1)
    broadcaster.sendTransform(first)
    broadcaster.sendTransform(transform("map", "b", 2, (9, 9, 9)))
    first.transform.translation.x = 7.0
    broadcaster.sendTransform([])
    graph.until(lambda: len(heard) == 3, "three messages")
    assert [xyz(message.transforms[0])[0] for message in heard] == [0, 0, 7]
    assert [len(message.transforms) for message in heard] == [1, 1, 1]


def test_a_listener_hears_another_process_even_what_was_sent_once_long_ago(graph):
    with Program("tests.tf2.talker") as program:
        logs = graph.listen(TFMessage, "/tf")
        graph.until(lambda: logs, "a transform")
        buffer = Buffer()
        listener = TransformListener(buffer, graph.node)
        graph.until(lambda: buffer.can_transform("odom", "laser", LATEST), "the whole way")
        found = buffer.lookup_transform("odom", "laser", LATEST)
        assert xyz(found) == pytest.approx([2, 0, 0.5])
        assert found.transform.rotation.z == pytest.approx(0.5**0.5)
        assert "broadcaster: 'default_authority'" in buffer.all_frames_as_yaml()
        listener.unregister()
        assert program.stop() == 0
    assert "Traceback" not in program.text()


def test_a_buffer_with_a_node_tells_its_frames_as_a_service(graph, node):
    buffer = Buffer(node=node)
    give(buffer, transform("odom", "base", 1))
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    answer = graph.ask(FrameGraph, "/tf2_frames")
    wait_for_arrival(buffer.srv)
    executor.spin_once(timeout_sec=0)
    assert graph.done(answer).frame_yaml == buffer.all_frames_as_yaml()
    executor.shutdown()


# how it waits and forgets


def test_a_lookup_waits_for_what_a_thread_hears(graph, node, buffer):
    listener = TransformListener(buffer, node, spin_thread=True)
    publisher = graph.publisher(TFMessage, "/tf")
    publisher.publish(TFMessage(transforms=[transform("odom", "base", 1, (1, 2, 3))]))
    found = buffer.lookup_transform("odom", "base", LATEST, timeout=Duration(seconds=30))
    assert xyz(found) == [1, 2, 3]
    listener.executor.shutdown()
    listener.dedicated_listener_thread.join()


def test_what_does_not_come_in_time_is_what_it_would_be_without_waiting(buffer):
    with pytest.raises(LookupException, match='"odom" passed to lookupTransform argument'):
        buffer.lookup_transform("odom", "base", LATEST, Duration(seconds=0.05))
    give(buffer, transform("odom", "base", 1), transform("world", "other", 1))
    with pytest.raises(ConnectivityException):
        buffer.lookup_transform("odom", "other", LATEST, timeout=Duration(nanoseconds=1))
    assert buffer.can_transform("odom", "other", LATEST, Duration(seconds=0.05)) == 0
    can, why = buffer.can_transform("odom", "mars", LATEST, return_debug_tuple=True)
    assert (can, why) == (
        0,
        'Invalid frame ID "mars" passed to canTransform argument source_frame - '
        "frame does not exist",
    )


def test_a_lookup_between_two_times(buffer):
    give(buffer, *(transform("map", "odom", t, (t, 0, 0)) for t in (1, 2)))
    way = ("odom", at(1), "odom", at(2), "map")
    assert xyz(buffer.lookup_transform_full(*way)) == [1, 0, 0]
    assert buffer.can_transform_full(*way) == 1


def test_a_future_has_the_transform_when_it_comes(buffer):
    future = buffer.wait_for_transform_async("odom", "base", LATEST)
    full = buffer.wait_for_transform_full_async("odom", LATEST, "base", LATEST, "odom")
    give(buffer, transform("map", "odom", 1))
    assert not future.done()
    give(buffer, transform("odom", "base", 1))
    assert future.done() and future.result()
    assert full.done() and full.result()
    give(buffer, transform("odom", "base", 2))  # nobody waits any more
    assert buffer.wait_for_transform_async("odom", "base", at(1.5)).done()


def test_a_lookup_can_be_awaited(buffer):
    give(buffer, transform("odom", "base", 1, (1, 0, 0)))
    lookup = buffer.lookup_transform_async("odom", "base", LATEST)
    assert xyz(asyncio.run(lookup)) == [1, 0, 0]
    full = buffer.lookup_transform_full_async("odom", at(1), "base", LATEST, "odom")
    assert stamp_s(asyncio.run(full)) == 1


@pytest.mark.applies(OURS, reason="a way into the buffer's clock that others need not have")
def test_a_clock_that_goes_back_by_a_second_empties_the_buffer(node, capfd):
    buffer = Buffer(node=node)
    clock = node.get_clock()
    clock._set_ros_time_is_active(True)
    clock.set_ros_time_override(Time(seconds=10, clock_type=ClockType.ROS_TIME))
    give(buffer, transform("odom", "base", 1))
    capfd.readouterr()
    clock.set_ros_time_override(Time(seconds=9.5, clock_type=ClockType.ROS_TIME))
    assert buffer.can_transform("odom", "base", LATEST)
    clock.set_ros_time_override(Time(seconds=8, clock_type=ClockType.ROS_TIME))
    assert not buffer.can_transform("odom", "base", LATEST)
    said = capfd.readouterr().err
    assert "[tf2_buffer]: Detected jump back in time. Clearing tf buffer." in said


# messages of other types


def test_a_message_is_transformed_by_what_is_registered_for_its_type(buffer):
    give(buffer, transform("odom", "base", 1, (1, 2, 3)))
    point = PointStamped()
    point.header.frame_id, point.header.stamp = "base", at(1).to_msg()
    with pytest.raises(tf2_ros.TypeException) as raised:
        buffer.transform(point, "odom")
    assert raised.value.errstr == (
        "Type <class 'geometry_msgs.msg._point_stamped.PointStamped'> is not loaded or supported"
    )
    tf2_ros.TransformRegistration().add(PointStamped, lambda point, found: xyz(found))
    assert buffer.transform(point, "odom") == [1, 2, 3]
    assert buffer.transform_full(point, "odom", at(1), "odom") == [1, 2, 3]
    tf2_ros.ConvertRegistration().add_convert((list, tuple), tuple)
    assert buffer.transform(point, "odom", new_type=tuple) == (1, 2, 3)
    assert buffer.transform(point, "odom", new_type=list) == [1, 2, 3]
