"""Whole runs in real time: nothing is lost at the start, and what is ours stays out of sight."""

from pathlib import Path

import pytest

from grader.recording.recording import Recording
from grader.run import real_time
from grader.run.handover import Plan
from grader.run.opening import open_submission
from grader.scenes.scene import Limits
from grader.submission.start import EntryPoint, Submission
from tests import runs
from tests.tiers import others_are_more
from turtlesim_py.world.events import CmdVel, SetPen

PLAN = Plan(Limits(first_motion_s=5, rest_s=0.2, total_s=60))
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
rclpy.spin_until_future_complete(node, pen.call_async(SetPen.Request(r=1, g=2, b=3, width=4)))
""",
    "starts_late": "import time\ntime.sleep(5.1)\n"
    + HEAD
    + """
rclpy.init()
publisher = rclpy.create_node("driver").create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 1.0
publisher.publish(twist)
time.sleep(60)
""",
    "raises": "def main():\n    import rclpy.node\n    raise ValueError('mine')\n\nmain()\n",
}


def recorded(name: str) -> Recording:
    path = runs.written(FILES[name], f"{name}.py")
    return runs.recorded(path, PLAN, time="real")


@pytest.mark.parametrize(
    "name",
    others_are_more("it waits", ("commands_at_once", "starts_late"), "commands_at_once"),
)
def test_the_first_command_arrives(name: str) -> None:
    recording = recorded(name)
    assert (recording.run.outcome, len(recording.trace.of_kind(CmdVel))) == ("finished", 1)


def test_the_first_call_of_a_service_arrives() -> None:
    assert len(recorded("calls_at_once").trace.of_kind(SetPen)) == 1


def test_without_a_node_the_clock_of_the_run_starts_as_well(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(real_time, "FIRST_NODE_S", 0.3)
    (tmp_path / "sleeps.py").write_text("import time; time.sleep(60)\n")
    plan = Plan(Limits(first_motion_s=0.3, rest_s=0.2, total_s=60))
    with open_submission(tmp_path / "sleeps.py") as submission:
        run = real_time.run(submission, plan).run
    assert (run.outcome, run.simulated_s) == ("time_limit", pytest.approx(0.3, abs=0.1))


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
