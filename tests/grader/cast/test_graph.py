from pathlib import Path

from grader import grading

ASKS = """
import rclpy

rclpy.init()
node = rclpy.create_node("asks")
print([each.node_name for each in node.get_publishers_info_by_topic("/rosout")])
"""


def test_the_graph_shows_which_node_logs_and_not_what_is_recorded_of_it(tmp_path: Path) -> None:
    file = tmp_path / "asks.py"
    file.write_text(ASKS)
    assert grading.record(file, "talker").nominal.output == "['asks']\n"
