"""Whole runs in real time: nothing is lost at the start, and what is ours stays out of sight."""

from pathlib import Path

import pytest

from grader.recording.recording import Recording
from grader.run import real_time
from grader.run.plan import Plan
from grader.scenes.scene import Limits
from grader.submission.opening import EntryPoint, Submission
from tests import runs
from turtlesim_py.world.events import CmdVel, SetPen

PLAN = Plan(Limits(first_motion_s=3, rest_s=0.3, total_s=60))
#: For whom waits four seconds for a name that is nobody's, and for whom does nothing at all.
LONGER = Plan(Limits(first_motion_s=12, rest_s=0.3, total_s=60))
SHORTER = Plan(Limits(first_motion_s=1, rest_s=0.3, total_s=60))
PLANS = {"wrong_topic": LONGER, "never_a_node": SHORTER}
HEAD = """
import time
import rclpy
from geometry_msgs.msg import Twist
from turtlesim.srv import SetPen, TeleportAbsolute
"""
FILES = {
    "commands_at_once": HEAD
    + """
rclpy.init()
publisher = rclpy.create_node("driver").create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 1.0
publisher.publish(twist)
time.sleep(60)
""",
    "calls_at_once": HEAD
    + """
rclpy.init()
node = rclpy.create_node("driver")
pen = node.create_client(SetPen, "turtle1/set_pen")
pen.call_async(SetPen.Request(r=1, g=2, b=3, width=4))
time.sleep(60)
""",
    "starts_late": "import time\ntime.sleep(3.2)\n"
    + HEAD
    + """
rclpy.init()
publisher = rclpy.create_node("driver").create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 1.0
publisher.publish(twist)
time.sleep(60)
""",
    "wrong_topic": HEAD
    + """
rclpy.init()
node = rclpy.create_node("driver")
started = time.monotonic()
for number in range(10):
    node.create_publisher(Twist, "/turtle/cmd_vel", 10)
# together four seconds; one by one they would be forty
print(time.monotonic() - started < 20, flush=True)
""",
    "never_a_node": "while True: pass\n",
    "raises": "def main():\n    import rclpy.node\n    raise ValueError('mine')\n\nmain()\n",
}


def recorded(name: str) -> Recording:
    path = runs.written(FILES[name], f"{name}.py")
    return runs.recorded(path, PLANS.get(name, PLAN), time="real")


@pytest.mark.parametrize("name", ["commands_at_once", "starts_late"])
def test_the_first_command_arrives(name: str) -> None:
    recording = recorded(name)
    assert (recording.run.outcome, len(recording.trace.of_kind(CmdVel))) == ("finished", 1)


def test_the_first_call_of_a_service_arrives() -> None:
    assert len(recorded("calls_at_once").trace.of_kind(SetPen)) == 1


def test_a_wrong_name_costs_little_time() -> None:
    assert recorded("wrong_topic").output.endswith("True\n")


def test_without_a_node_the_clock_of_the_run_starts_as_well() -> None:
    assert recorded("never_a_node").run.outcome == "time_limit"
    assert recorded("never_a_node").run.simulated_s == pytest.approx(1.0, abs=0.1)


def test_a_traceback_shows_none_of_our_lines() -> None:
    assert "ValueError: mine" in recorded("raises").output
    assert "grader/run" not in recorded("raises").output


def started(root: Path, module: str, function: str) -> Recording:
    submission = Submission("handed in", root, EntryPoint(module, function), "")
    return real_time.run(submission, PLAN)


def test_an_entry_point_may_be_a_method(tmp_path: Path) -> None:
    (tmp_path / "node.py").write_text(
        "import sys\nclass Node:\n    @staticmethod\n    def main(): print(sys.argv)\n"
    )
    assert started(tmp_path, "node", "Node.main").output == "['node']\n"


def test_a_module_that_is_not_the_submission_s_is_named(tmp_path: Path) -> None:
    (tmp_path / "signal.py").write_text("def main(): print('mine')\n")
    recording = started(tmp_path, "signal", "main")
    assert recording.run.outcome == "crashed"
    assert "'signal' is also the name of a module" in recording.output
