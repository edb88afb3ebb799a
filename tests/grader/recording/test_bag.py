"""The bag is a rosbag2 of ROS 2 Jazzy: read here by other programs than the one that wrote it."""

import json
from collections import Counter
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

from grader.recording import bag, mcap, reading, saving
from grader.recording.recording import Recordings
from grader.ros.bag_types import OF_ROS
from grader.ros.definitions import Definitions
from grader.ros.messages import serialise
from grader.scenes.scene import load_scene
from tests import archive
from tests.grader.driving import drive, pen, twist
from tests.grader.recording.slow_bag import Rosbag2Writer, types_of

TICK_NS = 16_000_000
TOPICS = {
    "/turtle1/pose": ("turtlesim/msg/Pose", 9),
    "/turtle1/color_sensor": ("turtlesim/msg/Color", 9),
    "/second/pose": ("turtlesim/msg/Pose", 7),
    "/second/color_sensor": ("turtlesim/msg/Color", 7),
    "/turtle1/cmd_vel": ("geometry_msgs/msg/Twist", 3),
    "/second/cmd_vel": ("geometry_msgs/msg/Twist", 1),
    "/turtlesim/events": ("std_msgs/msg/String", 4),
    "/rosout": ("rcl_interfaces/msg/Log", 2),
    "/turtlesim/path": ("sensor_msgs/msg/Image", 1),
    "/turtlesim/window": ("sensor_msgs/msg/Image", 1),
}
READING = ("pose", "color_sensor")


def couple(tick, _, arena):
    """Two turtles; the second one comes in tick 3."""
    if tick == 3:
        twist(arena, 1.0)
        pen(arena, (255, 0, 0))
        arena.spawn(2.0, 3.0, 1.0, "second")
        twist(arena, -0.1, 1 / 3)
        arena.command("second", (0.5, float("inf"), 0.0), (0.0, 0.0, float("nan")))
        arena.clear()
        arena.set_pen("second", 1, 2, 3, 4, 5)
        twist(arena, 2.0)


@pytest.fixture(scope="module")
def recorded():
    return drive(couple, ticks=9)


@pytest.fixture(scope="module")
def folder(recorded, tmp_path_factory):
    folder = tmp_path_factory.mktemp("bag") / "recording"
    saving.save_all(Recordings(recorded), folder)
    return folder


@pytest.fixture(scope="module")
def decoded(folder):
    """(topic, time, message) as the MCAP project's own reader finds them."""
    with (folder / "recording.mcap").open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        return [
            (channel.topic, message.log_time, ros_message)
            for _, channel, message, ros_message in reader.iter_decoded_messages()
        ]


def on(topic, decoded):
    return [(time, message) for where, time, message in decoded if where == topic]


def test_the_type_hashes_are_those_of_the_installed_interfaces(folder):
    from ament_index_python.packages import get_package_share_directory

    metadata = yaml.safe_load((folder / "metadata.yaml").read_text())
    for topic in metadata["rosbag2_bagfile_information"]["topics_with_message_count"]:
        package, _, name = (kind := topic["topic_metadata"]["type"]).split("/")
        path = Path(get_package_share_directory(package), "msg", f"{name}.json")
        hashes = json.loads(path.read_text())["type_hashes"]
        (expected,) = (h["hash_string"] for h in hashes if h["type_name"] == kind)
        assert topic["topic_metadata"]["type_description_hash"] == expected


def test_poses_and_colors_are_those_of_the_recording_at_16_ms_a_tick(decoded, recorded):
    for name, way in recorded.trace.trajectories.items():
        poses, colors = (on(f"/{name}/{what}", decoded) for what in READING)
        found = [
            (p.x, p.y, p.theta, p.linear_velocity, p.angular_velocity, c.r, c.g, c.b)
            for (_, p), (_, c) in zip(poses, colors, strict=True)
        ]
        assert np.array_equal(np.array(found), way.rows()[:, 1:], equal_nan=True)
        assert [time for time, _ in poses] == (way.ticks * TICK_NS).tolist()
    assert [time for time, _ in on("/turtlesim/window", decoded)] == [9 * TICK_NS]


def test_commands_are_twists_to_the_last_bit(decoded):
    (_, first), (_, second), _ = on("/turtle1/cmd_vel", decoded)
    assert (first.linear.x, first.angular.z) == (1.0, 1.0)
    assert (second.linear.x, second.angular.z) == (-0.1, 1 / 3)
    ((_, odd),) = on("/second/cmd_vel", decoded)
    assert odd.linear.y == float("inf")
    assert np.isnan(odd.angular.z)


def test_the_inputs_of_a_tick_stand_in_their_order_and_before_their_effects(decoded):
    tick = [(topic, message) for topic, time, message in decoded if time == 3 * TICK_NS]
    inputs = [
        json.loads(message.data)["op"] if topic == "/turtlesim/events" else topic
        for topic, message in tick
        if topic.endswith(("/cmd_vel", "/events"))
    ]
    one, two = "/turtle1/cmd_vel", "/second/cmd_vel"
    assert inputs == [one, "set_pen", "spawn", one, two, "clear", "set_pen", one]
    effects = [f"/{name}/{what}" for name in ("turtle1", "second") for what in READING]
    assert [topic for topic, _ in tick][len(inputs) :] == ["/rosout", "/rosout", *effects]
    (_, spawned), (_, cleared) = on("/rosout", decoded)
    assert spawned.msg.startswith("Spawning turtle [second] at x=[2.000000]")
    assert (cleared.level, cleared.name, cleared.msg) == (20, "turtlesim", "Clearing turtlesim.")
    assert (cleared.stamp.sec, cleared.stamp.nanosec) == (0, 3 * TICK_NS)


def test_the_pictures_are_images_of_the_canvas_and_the_window(decoded, recorded):
    for topic, pixels, encoding in (
        ("/turtlesim/path", recorded.trace.canvas, "rgba8"),
        ("/turtlesim/window", recorded.trace.window, "rgb8"),
    ):
        ((_, image),) = on(topic, decoded)
        assert (image.width, image.height, image.encoding) == (500, 500, encoding)
        assert image.step == 500 * pixels.shape[2]
        assert bytes(image.data) == pixels.tobytes()


def test_the_real_rclpy_reads_the_messages(folder, recorded):
    from rclpy.serialization import deserialize_message

    found = Counter()
    with AnyReader([folder]) as reader:
        assert {topic: info.msgtype for topic, info in reader.topics.items()} == {
            topic: kind for topic, (kind, _) in TOPICS.items()
        }
        for connection, _, data in reader.messages():
            package, _, name = connection.msgtype.split("/")
            kind = getattr(import_module(f"{package}.msg"), name)
            message = deserialize_message(bytes(data), kind)
            found[connection.topic] += 1
            if connection.topic == "/turtlesim/window":
                assert bytes(message.data) == recorded.trace.window.tobytes()
            if connection.topic == "/second/cmd_vel":
                assert (message.linear.x, message.linear.y) == (0.5, float("inf"))
    assert found == {topic: count for topic, (_, count) in TOPICS.items()}


def test_it_is_the_bag_that_rosbags_writes_message_by_message(tmp_path, monkeypatch):
    """Metadata, chunks, indices and counts too; a run of three minutes fills several chunks."""
    monkeypatch.setattr(mcap, "LIBRARY", f"rosbags-{version('rosbags')}")
    scene = load_scene("turtlesim")

    def drive_on(tick, pose, arena):
        couple(tick, pose, arena)
        if tick % 50 == 0:
            twist(arena, 1.0, 1.0)

    trace = drive(drive_on, ticks=11_000).trace
    quick = bag.write(trace, scene, tmp_path / "quick" / "recording")
    types = types_of(OF_ROS)
    writer = Rosbag2Writer(tmp_path / "slow" / "recording")
    connections = {}
    with writer:
        for topic, msgtype in scene.bag_topics(trace):
            connections[topic] = writer.add_connection(topic, msgtype, typestore=types)
        for time_ns, topic, msgtype, data in scene.to_messages(trace):
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, msgtype, typestore=types)
            again = types.serialize_cdr(
                types.deserialize_cdr(data, msgtype), msgtype, little_endian=True
            )
            writer.write(connections[topic], time_ns, again)
    with quick.open("rb") as stream:
        assert len(make_reader(stream).get_summary().chunk_indexes) > 2
    for name in ("recording.mcap", "metadata.yaml"):
        slow = tmp_path / "slow" / "recording" / name
        assert (quick.parent / name).read_bytes() == slow.read_bytes()


def test_a_channel_may_have_a_type_of_a_hand_ins(recorded, tmp_path):
    texts = {
        "mine/msg/Num": "int8 num\nstring<=5 name\n",
        "mine/msg/Nums": "std_msgs/Header header\nNum[<=3] nums\ngeometry_msgs/Point at\n",
        "mine/srv/Add": "Num a\n---\nNum b\n",
    }
    own = Definitions(texts)
    number, numbers = own.type("mine/msg/Num"), own.type("mine/msg/Nums")
    data = serialise(numbers(nums=[number(num=7, name="seven")]))

    class Listening(type(load_scene("turtlesim"))):
        def definitions_of(self, trace):
            own = {name: text for name, text in texts.items() if "/msg/" in name}
            point = {"geometry_msgs/msg/Point": "float64 x\nfloat64 y\nfloat64 z\n"}
            return {**super().definitions_of(trace), **own, **point}

        def bag_topics(self, trace):
            return [("/nums", "mine/msg/Nums")]

        def to_messages(self, trace):
            return [*super().to_messages(trace), (10**9, "/nums", "mine/msg/Nums", data)]

    bag.write(recorded.trace, Listening(), tmp_path / "recording")
    with (tmp_path / "recording" / "recording.mcap").open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        ((_, channel, _, message),) = reader.iter_decoded_messages(topics=["/nums"])
    assert (message.nums[0].num, message.nums[0].name, message.at.x) == (7, "seven", 0.0)
    with AnyReader([tmp_path / "recording"]) as reader:
        digest = reader.typestore.hash_rihs01("mine/msg/Nums")
        assert channel.metadata["topic_type_hash"] == digest
        assert reader.topics["/nums"].msgtype == "mine/msg/Nums"


@pytest.mark.parametrize("name", ["follow_me", "talker_listener", "own_interfaces"])
def test_a_recording_that_is_read_and_saved_again_has_the_same_bytes(name, tmp_path):
    folder = archive.folder(name, "right")
    saving.save_all(reading.load_all(folder), tmp_path / "again")
    for file in filter(Path.is_file, folder.rglob("*")):
        again = tmp_path / "again" / file.relative_to(folder)
        assert again.read_bytes() == file.read_bytes(), again
