"""Where ROS is sourced: rosbag2_py reads what was recorded, and ros2 bag plays it."""

import shutil
import subprocess
from importlib.util import find_spec

import pytest
import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import SingleThreadedExecutor
from rclpy.serialization import deserialize_message

from grader.recording import bag, saving
from grader.recording.recording import Recordings
from tests.grader.driving import Spiral, drive

pytestmark = pytest.mark.applies(
    bool(shutil.which("ros2") and find_spec("rosbag2_py")), reason="ROS's rosbag2 is there"
)
#: Of a type that every release has.
TOPIC = "/turtle1/cmd_vel"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bag") / "recording"
    saving.save_all(Recordings(drive(Spiral(), ticks=60)), folder)
    return folder


@pytest.fixture(scope="module")
def messages(folder):
    channels = bag.read_channels(folder / "recording.mcap")
    return {channel.topic: list(channel.messages()) for channel in channels}


def test_rosbag2_py_reads_every_message(folder, messages):
    import rosbag2_py

    reader = rosbag2_py.SequentialReader()
    storage = rosbag2_py.StorageOptions(uri=str(folder), storage_id="mcap")
    reader.open(storage, rosbag2_py.ConverterOptions("cdr", "cdr"))
    assert {topic.name for topic in reader.get_all_topics_and_types()} == set(messages)
    found = {topic: [] for topic in messages}
    while reader.has_next():
        topic, data, _ = reader.read_next()
        found[topic].append(bytes(data))
    assert found == messages


def test_ros2_bag_play_publishes_the_commands(folder, messages):
    heard = []
    context = rclpy.Context()
    rclpy.init(context=context)
    executor = SingleThreadedExecutor(context=context)
    node = rclpy.create_node("listener_of_a_bag", context=context)
    executor.add_node(node)
    node.create_subscription(Twist, TOPIC, heard.append, 100)
    # --delay: until it has found the subscription
    call = ["ros2", "bag", "play", folder, "--topics", TOPIC, "--delay", "5"]
    call += ["--wait-for-all-acked", "9000", "--disable-keyboard-controls"]
    try:
        with subprocess.Popen(call, stdin=subprocess.DEVNULL) as player:
            while player.poll() is None:
                executor.spin_once(timeout_sec=0.1)
        for _ in messages[TOPIC]:  # those that have come, and were not taken yet
            executor.spin_once(timeout_sec=0.1)
    finally:
        executor.shutdown()
        node.destroy_node()
        context.try_shutdown()
    assert player.returncode == 0
    assert heard == [deserialize_message(data, Twist) for data in messages[TOPIC]]
