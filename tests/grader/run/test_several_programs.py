"""Several programs of a launch file in virtual time, each in a process of its own."""

from __future__ import annotations

from pathlib import Path

import pytest

from grader.errors import SubmissionError
from grader.recording.recording import Recording
from grader.run import real_time, virtual_time
from grader.run.handover import Plan
from grader.run.limits import Patience
from grader.run.opening import open_submission
from grader.run.processes import levels
from grader.run.processes.levels import LANDLOCK, LIMITS
from grader.scenes.scene import Limits
from tests import runs
from tests.grader.run import conftest
from tests.runs import SUBMISSIONS
from tests.tiers import others_are_more
from turtlesim_py.world.events import CmdVel, SetPen

LAUNCHED = SUBMISSIONS / "launched"
PLAN = Plan(Limits(first_motion_s=20, rest_s=0.3, total_s=6))


CLOCKS = {"virtual": virtual_time.run, "real": real_time.run}
either_clock = pytest.mark.parametrize(
    "clock", others_are_more("the same launch file, for seconds", CLOCKS, "virtual")
)


def recorded(
    folder: Path, plan: Plan = PLAN, executable: str | None = None, clock: str = "virtual"
) -> Recording:
    with open_submission(folder, executable) as submission:
        recording = CLOCKS[clock](submission, plan)
    assert recording.run.time == clock, recording.run.flags
    return recording


def said(recording: Recording, name: str) -> list[str]:
    """What a program has printed."""
    mark = f"[{name}] "
    lines = recording.output.splitlines()
    return [line.removeprefix(mark) for line in lines if line.startswith(mark)]


@pytest.fixture(scope="module")
def conversation() -> Recording:
    """The programs that talk with each other; they do not drive."""
    still = Plan(Limits(first_motion_s=4, rest_s=4, total_s=4))
    return recorded(LAUNCHED / "conversation", still)


def test_both_nodes_run_with_what_the_launch_file_gives_them() -> None:
    recording = recorded(LAUNCHED / "spiral")
    assert recording.run.flags == ()
    events = recording.trace.events
    assert any(isinstance(event, CmdVel) for event in events), recording.output
    assert {event.width for event in events if isinstance(event, SetPen)} == {5}


def test_what_one_sends_the_other_hears_at_that_moment(conversation: Recording) -> None:
    times = [10_000_000 + second * 10**9 for second in range(4)]
    assert said(conversation, "listener-2")[1:] == [
        f"hello {100 * second} {time_ns}" for second, time_ns in enumerate(times)
    ]


def test_one_waits_for_the_service_of_another(conversation: Recording) -> None:
    assert said(conversation, "asker-3") == ["not yet", "0", "2", "4"]


def test_who_comes_late_is_told_what_is_kept(conversation: Recording) -> None:
    assert said(conversation, "late-5")[1] == "first weather"


def test_each_sees_those_that_are_there_and_no_more(conversation: Recording) -> None:
    first, *_ = said(conversation, "listener-2")
    assert first == "['listener', 'talker', 'turtlesim'] 1"
    assert said(conversation, "late-5")[0].startswith("False ")  # the asker has ended
    there = ["adder", "dies", "late", "listener", "talker", "turtlesim"]
    assert said(conversation, "dies-6")[1] == str(there)


def test_each_draws_its_own_random_numbers(conversation: Recording) -> None:
    late, dies = said(conversation, "late-5")[0].split()[1], said(conversation, "dies-6")[0]
    assert late != dies


def test_who_dies_ends_nobody_else_and_is_the_one_to_blame(conversation: Recording) -> None:
    assert (conversation.run.outcome, conversation.run.exit_code) == ("crashed", 3)
    assert len(said(conversation, "listener-2")) == 5


CONTROLLER = """
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose

class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        self.velocity = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.timer = self.create_timer(1.0, self.look)
        self.timer_of_speed = self.create_timer(0.25, self.drive)

    def look(self):  # after ticks that were foreseen
        self.timer.cancel()
        self.create_subscription(Pose, "/turtle1/pose", self.seen, 10)

    def drive(self):
        twist = Twist()
        twist.linear.x = 1.0
        self.velocity.publish(twist)

    def seen(self, pose):
        twist = Twist()
        twist.linear.x, twist.angular.z = 1.0, pose.x - 5.0
        self.velocity.publish(twist)

def main():
    rclpy.init()
    rclpy.spin(Controller())
"""
IDLE = """
import time

def main():
    time.sleep(60.0)
"""
SETUP = """
from setuptools import setup
setup(name="company", packages=["company"],
      data_files=[("share/company/launch", ["launch/all.launch.py"])],
      entry_points={"console_scripts": [f"{n} = company.{n}:main" for n in NAMES]})
"""
LAUNCH = """
from launch import LaunchDescription
from launch_ros.actions import Node

def generate_launch_description():
    return LaunchDescription([Node(package="company", executable=name) for name in NAMES])
"""
DRIVES = """
import rclpy
from geometry_msgs.msg import Twist

def main():
    rclpy.init()
    node = rclpy.create_node("drives")
    velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
    twist = Twist()
    twist.linear.x = 1.0
    node.create_timer(0.1, lambda: velocity.publish(twist))
    rclpy.spin(node)
"""
COMPUTES = """
import time

def main():
    time.sleep(1.0)
    while True:
        pass
"""
RAISES = """
import time

def main():
    time.sleep(2.0)
    raise ValueError("no more")
"""


def package(folder: Path, **programs: str) -> Path:
    """A package whose launch file starts these programs, in this order."""
    names = repr(list(programs))
    files = {
        "package.xml": "<package><name>company</name></package>",
        "setup.py": SETUP.replace("NAMES", names),
        "launch/all.launch.py": LAUNCH.replace("NAMES", names),
        "company/__init__.py": "",
        **{f"company/{name}.py": text for name, text in programs.items()},
    }
    for name, text in files.items():
        file = folder / "company" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return folder / "company"


ORDERS = ("controller, idle", "idle, controller")


@pytest.mark.parametrize("order", others_are_more("one of both", ORDERS, "idle, controller"))
def test_beside_an_idle_one_a_program_does_what_it_does_alone(tmp_path: Path, order: str) -> None:
    programs = {"controller": CONTROLLER, "idle": IDLE}
    folder = package(tmp_path, **{name: programs[name] for name in order.split(", ")})
    both, alone = recorded(folder), recorded(folder, executable="controller")
    assert both.run.trace_sha256 == alone.run.trace_sha256


def test_who_computes_without_end_stalls_alone_and_the_first_that_failed_is_to_blame(
    tmp_path: Path,
) -> None:
    folder = package(tmp_path, raises=RAISES, computes=COMPUTES, drives=DRIVES)
    with open_submission(folder) as submission:
        recording = virtual_time.run(submission, PLAN, patience=Patience(stall_cpu_s=0.5))
    assert (recording.run.time, recording.run.outcome) == ("virtual", "stalled")
    assert "[raises-1] ValueError: no more" in recording.output
    times_s = [event.tick * 0.016 for event in recording.trace.of_kind(CmdVel)]
    assert times_s[-1] > 5.5, times_s  # who drives goes on to the end


STAMPS = """
import time

def main():
    for _ in range(3):
        print(round(time.time() % 1000, 3), flush=True)
        time.sleep(0.5)
"""
LATER = """
from launch import LaunchDescription
from launch.actions import TimerAction
from launch_ros.actions import Node

def generate_launch_description():
    late, node = (Node(package="company", executable="stamps") for _ in range(2))
    return LaunchDescription([TimerAction(period=1.25, actions=[late]), node, *OTHERS])
""".replace("*OTHERS", 'Node(package="company", executable="drives")')


def test_what_is_to_start_later_runs_from_then_on(tmp_path: Path) -> None:
    folder = package(tmp_path, stamps=STAMPS, drives=DRIVES)
    (folder / "launch/all.launch.py").write_text(LATER)
    recording = recorded(folder)
    begin = float(said(recording, "stamps-1")[0])
    late = [float(line) - begin for line in said(recording, "stamps-3")]
    assert late == pytest.approx([1.25, 1.75, 2.25], abs=1e-3)


def test_what_was_to_start_after_the_end_was_not_run(tmp_path: Path) -> None:
    folder = package(tmp_path, stamps=STAMPS, drives=DRIVES)
    (folder / "launch/all.launch.py").write_text(LATER.replace("1.25", "60.0"))
    run = recorded(folder).run
    assert (run.programs[2].name, run.programs[2].outcome) == ("stamps-3", "not_run")
    assert "stamps-3 was to start at 60 s, when the run was over" in map(str, run.flags)


@either_clock
def test_each_program_is_in_the_result_with_how_it_has_ended(tmp_path: Path, clock: str) -> None:
    folder = package(tmp_path, raises=RAISES, stamps=STAMPS, drives=DRIVES)
    run = recorded(folder, clock=clock).run
    ends = [(each.name, each.exit_code) for each in run.programs]
    assert ends == [("raises-1", 1), ("stamps-2", 0), ("drives-3", None)]
    assert (run.outcome, run.programs[0].outcome) == ("crashed", "crashed")
    assert {(each.package, each.executable) for each in run.programs} == {
        ("company", "raises"), ("company", "stamps"), ("company", "drives")
    }  # fmt: skip
    assert run.programs[0].output.endswith("ValueError: no more\n")
    assert len(run.programs[1].output.splitlines()) == 3


WRITES = """
import os, time

def main():
    for folder in (".", "/tmp", "/dev/shm"):
        with open(folder + "/map", "w") as file:
            file.write("house")
    time.sleep(2.0)
    print("map" in os.listdir("/tmp"), os.path.exists("again"))
"""
READS = """
import os, time

def main():
    time.sleep(1.0)
    print([open(folder + "/map").read() for folder in (".", "/tmp", "/dev/shm")])
    os.rename("map", "again")
    print(os.readlink("/proc/self") == str(os.getpid()), os.path.exists("/dev/stdout"))
"""


def test_what_one_writes_the_others_find_as_at_a_desk(tmp_path: Path) -> None:
    recording = recorded(package(tmp_path, writes=WRITES, reads=READS))
    assert said(recording, "reads-2") == ["['house', 'house', 'house']", "True True"]
    assert said(recording, "writes-1") == ["True True"]


AFTER = """
from launch import LaunchDescription
from launch.actions import RegisterEventHandler, TimerAction
from launch.event_handlers import OnProcessExit
from launch_ros.actions import Node

def generate_launch_description():
    names = ("stamps", "drives", "raises", "late")
    stamps, drives, raises, late = (Node(package="company", executable=name) for name in names)
    later = [TimerAction(period=0.5, actions=[late])]
    return LaunchDescription([
        RegisterEventHandler(OnProcessExit(target_action=raises, on_exit=later)),
        RegisterEventHandler(OnProcessExit(target_action=drives, on_exit=[stamps])),
        drives, raises,
    ])
"""


@either_clock
def test_what_waits_for_the_end_of_another_starts_then_or_was_not_run(
    tmp_path: Path, clock: str
) -> None:
    folder = package(tmp_path, stamps=STAMPS, drives=DRIVES, raises=RAISES, late=STAMPS)
    (folder / "launch/all.launch.py").write_text(AFTER)
    recording = recorded(folder, clock=clock)
    told = {each.name: each.exit_code for each in recording.run.programs}
    assert [told["drives-1"], told["raises-2"], told["late-4"]] == [None, 1, 0]
    assert len(said(recording, "late-4")) == 3
    if clock == "virtual":
        assert recording.run.programs[2].outcome == "not_run"
        flag = "stamps-3 was to start at the end of drives-1, which did not come"
        assert flag in map(str, recording.run.flags)
        assert float(said(recording, "late-4")[0]) == pytest.approx(2.5, abs=0.01)


@either_clock
def test_what_is_to_be_started_again_is_at_its_end(tmp_path: Path, clock: str) -> None:
    folder = package(tmp_path, stamps=STAMPS, drives=DRIVES)
    again = "executable=name, respawn=name == 'stamps', respawn_delay=0.25)"
    text = LAUNCH.replace("NAMES", "['drives', 'stamps']").replace("executable=name)", again)
    (folder / "launch/all.launch.py").write_text(text)
    with open_submission(folder) as submission:
        notes = list(map(str, submission.notes))
        recording = CLOCKS[clock](submission, PLAN)
    assert "stamps of launch/all.launch.py is started again 3 times at most" in notes
    names = [each.name for each in recording.run.programs]
    assert names == ["drives-1", *["stamps-2"] * len(names[1:])]
    if clock == "virtual":
        begins = [float(line) for line in said(recording, "stamps-2")[::3]]
        assert begins == pytest.approx([0.0, 1.75, 3.5, 5.25], abs=0.01)


YAML = """
drives: {ros__parameters: {rate: 2.5}}
/**: {ros__parameters: {frame: map}}
others: {ros__parameters: {frame: odom}}
"""
TELLS = """
import rclpy

def main():
    rclpy.init()
    node = rclpy.create_node("drives", automatically_declare_parameters_from_overrides=True)
    print(node.get_name(), *(node.get_parameter_or(n).value for n in ("rate", "frame", "own")))
"""


def test_a_file_of_parameters_is_for_the_nodes_that_it_names(tmp_path: Path) -> None:
    folder = package(tmp_path, tells=TELLS, other=TELLS.replace('"drives"', '"other"'))
    (folder / "config").mkdir()
    (folder / "config/all.yaml").write_text(YAML)
    share = 'FindPackageShare("company"), "/config/all.yaml"'
    text = LAUNCH.replace("NAMES", "['tells', 'other']").replace(
        "executable=name)", f"executable=name, parameters=[[{share}], {{'own': '5'}}])"
    )
    head = "from launch_ros.substitutions import FindPackageShare\n"
    (folder / "launch/all.launch.py").write_text(head + text)
    setup = folder / "setup.py"
    files = '("share/company/config", ["config/all.yaml"]), ("share/company/launch"'
    setup.write_text(setup.read_text().replace('("share/company/launch"', files))
    recording = recorded(folder)
    assert said(recording, "tells-1") == ["drives 2.5 map 5"]
    assert said(recording, "other-2") == ["other None map 5"]


PREPARES = "import pathlib, sys\nprint(pathlib.Path(sys.argv[2]).read_text(), sys.argv[1])\n"


def test_a_script_of_its_own_is_started_by_its_path(tmp_path: Path) -> None:
    folder = package(tmp_path, drives=DRIVES)
    (folder / "prepare.py").write_text(PREPARES)
    command = "['python3', HERE + '/prepare.py', '--map', HERE + '/package.xml']"
    also = f"for name in ['drives']] + [ExecuteProcess(cmd={command})"
    text = LAUNCH.replace("for name in NAMES", also)
    head = "import os\nfrom launch.actions import ExecuteProcess\n"
    head += "HERE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))\n"
    (folder / "launch/all.launch.py").write_text(head + text)
    setup = folder / "setup.py"
    files = '("share/company", ["prepare.py", "package.xml"]), ("share/company/launch"'
    setup.write_text(setup.read_text().replace('("share/company/launch"', files))
    recording = recorded(folder)
    assert said(recording, "python3-2") == ["<package><name>company</name></package> --map"]
    last = recording.run.programs[1]
    assert (last.package, last.executable, last.exit_code) == ("", "prepare.py", 0)


STARTS_A_PROCESS = """
import subprocess

def main():
    subprocess.run(["true"])
"""


@pytest.mark.more("a run in each time")
def test_where_one_cannot_be_followed_all_run_in_real_time_and_it_is_named(tmp_path: Path) -> None:
    folder = package(tmp_path, drives=DRIVES, starts=STARTS_A_PROCESS)
    with open_submission(folder) as submission:
        run = virtual_time.run(submission, PLAN).run
    assert run.time == "real"
    flag = "graded in real time, because the submission starts another program (true) (starts-2)"
    assert str(run.flags[0]) == flag
    assert [each.name for each in run.programs] == ["drives-1", "starts-2"]


@pytest.mark.more("tests/attacks run one of several at each level")
@pytest.mark.parametrize("level", [LANDLOCK, LIMITS])
def test_they_run_at_a_lower_level_of_isolation_too(level: str) -> None:
    levels.only(level)
    try:
        run = recorded(LAUNCHED / "spiral").run  # its launch file is evaluated at that level, too
    except levels.NotOffered:
        pytest.skip("not offered here")
    finally:
        levels.only("")
    assert [(each.outcome, each.exit_code) for each in run.programs] == [("time_limit", None)] * 2


def test_a_program_alone_is_in_the_result_too() -> None:
    (program,) = runs.recorded("quick_spiral", Plan(conftest.LIMITS)).run.programs
    told = (program.name, program.package, program.executable)
    assert told == ("quick_spiral.py", "", "quick_spiral.py")


def test_a_ninth_program_is_refused(tmp_path: Path) -> None:
    folder = package(tmp_path, **{f"idle{n}": IDLE for n in range(9)})
    with pytest.raises(SubmissionError, match=r"all.launch.py starts 9 programs; a run may have 8"):
        recorded(folder)
