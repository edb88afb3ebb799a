"""Whole runs in real time: nothing is lost at the start."""

from pathlib import Path

import pytest

from grader.recording.recording import Recording
from grader.run import real_time
from grader.run.handover import Plan
from grader.run.opening import open_submission
from grader.scenes.scene import Limits
from tests import runs
from tests.tiers import others_are_more
from turtlesim_py.world.events import CmdVel, SetPen

PLAN = Plan(Limits(first_motion_s=5, rest_s=0.2, total_s=60))
FILES = {
    "commands_at_once": """
import time
START
import rclpy
from geometry_msgs.msg import Twist
rclpy.init()
publisher = rclpy.create_node("driver").create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 1.0
publisher.publish(twist)
time.sleep(60)
""",
    "calls_at_once": """
import rclpy
from turtlesim.srv import SetPen
rclpy.init()
node = rclpy.create_node("driver")
pen = node.create_client(SetPen, "turtle1/set_pen")
rclpy.spin_until_future_complete(node, pen.call_async(SetPen.Request(r=1, g=2, b=3, width=4)))
""",
}
FILES["starts_late"] = FILES["commands_at_once"].replace("START", "time.sleep(5.1)")
FILES["commands_at_once"] = FILES["commands_at_once"].replace("START", "")


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


@pytest.mark.more("the first command stands for it")
def test_the_first_call_of_a_service_arrives() -> None:
    assert len(recorded("calls_at_once").trace.of_kind(SetPen)) == 1


@pytest.mark.more("it waits for a node")
def test_without_a_node_the_clock_of_the_run_starts_as_well(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(real_time, "FIRST_NODE_S", 0.3)
    (tmp_path / "sleeps.py").write_text("import time; time.sleep(60)\n")
    plan = Plan(Limits(first_motion_s=0.3, rest_s=0.2, total_s=60))
    with open_submission(tmp_path / "sleeps.py") as submission:
        run = real_time.run(submission, plan).run
    assert (run.outcome, run.simulated_s) == ("time_limit", pytest.approx(0.3, abs=0.1))
