from importlib import metadata
from itertools import pairwise

import pytest

from grader import grading

ASKS = """
import rclpy

rclpy.init()
node = rclpy.create_node("asks")
print([each.node_name for each in node.get_publishers_info_by_topic("/rosout")])
"""


@pytest.mark.applies(metadata.version("rclpy").startswith("7."), reason="later all peers log")
def test_the_graph_shows_which_node_logs_and_not_what_is_recorded_of_it(tmp_path):
    file = tmp_path / "asks.py"
    file.write_text(ASKS)
    assert grading.record(file, "talker").nominal.output == "['asks']\n"


SENDS = """
import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("minimal_publisher")
publisher = node.create_publisher(String, "topic", 10)
node.create_timer({period}, lambda: publisher.publish(String(data="Hello")))
rclpy.spin(node)
"""


@pytest.mark.parametrize("period_ms", [5, 41])
def test_a_message_has_its_own_time_within_a_tick(tmp_path, period_ms):
    file = tmp_path / "sends.py"
    file.write_text(SENDS.format(period=period_ms / 1000))
    trace = grading.record(file, "talker").nominal.trace
    times_ns = [each.time_ns for each in trace.sent("/topic")]
    assert len(times_ns) > 100
    assert {b - a for a, b in pairwise(times_ns)} == {period_ms * 1_000_000}
