"""What stands in the environment that `make install` or `pip install .` has made."""

import importlib.util
import os
import re
import subprocess
import sys
import sysconfig
from importlib.metadata import version
from pathlib import Path

import pytest

from tests.programs import ran

from .conftest import ROOT

PROGRAMS = [
    ("turtlesim_py", "turtlesim_node"),
    ("turtlesim_challenge", "turtle_controller"),
    ("grader", "grader"),
    ("grader_robots", "robot_state_publisher"),
    ("grader_robots", "joint_state_publisher"),
]
without_ros = pytest.mark.applies("ROS_DISTRO" not in os.environ, reason="ROS has its own")
#: The tutorials' `ros2 run turtlesim ...`.
TUTORIALS = ["turtlesim_node", "turtle_teleop_key", "draw_square", "mimic"]


@pytest.fixture
def shell(shell):
    others = shell.get("AMENT_PREFIX_PATH", "")
    return shell | {"AMENT_PREFIX_PATH": os.pathsep.join([sys.prefix, others])}


@pytest.mark.parametrize(("package", "program"), PROGRAMS)
def test_ros2_run_finds_each_program(ros2_run, shell, package, program):
    path = ros2_run(package, program, shell)
    assert path.is_relative_to(sys.prefix)
    assert os.access(Path(sys.prefix, "bin", program), os.X_OK)


def test_ros2_run_starts_the_simulator(ros2_run, run_until_started, shell):
    path = ros2_run("turtlesim_py", "turtlesim_node", shell)
    assert "Starting turtlesim" in run_until_started(path, shell)


@without_ros
def test_ros2_run_turtlesim_finds_the_programs_of_the_tutorials(ros2_run, run_until_started, shell):
    found = {program: ros2_run("turtlesim", program, shell) for program in TUTORIALS}
    assert all(path.is_relative_to(sys.prefix) for path in found.values())
    assert "Starting turtlesim" in run_until_started(found["turtlesim_node"], shell)


@without_ros
def test_ros2_run_finds_the_nodes_of_robots_by_the_names_of_ros_s_packages(
    ros2_run, run_until_started, shell
):
    for name in ("robot_state_publisher", "joint_state_publisher"):
        assert ros2_run(name, name, shell).is_relative_to(sys.prefix)
    node = ros2_run("joint_state_publisher", "joint_state_publisher", shell)
    run_until_started(node, shell, sign="Waiting for robot_description")


@without_ros
def test_ros2_launch_turtlesim_finds_multisim():
    """PyPI has no launch; what the file would start is tested in test_multisim."""
    ours, theirs = (
        Path(sys.prefix, "share", package, "launch", "multisim.launch.py")
        for package in ("turtlesim_py", "turtlesim")
    )
    assert ours.read_bytes() == theirs.read_bytes()


def test_programs_get_their_arguments(ros2_run, shell):
    path = ros2_run("grader", "grader", shell)
    help_ = ran([path, "run", "--help"], env=shell)
    assert help_.returncode == 0, help_.stderr
    assert "submission" in help_.stdout


@pytest.mark.parametrize(
    "package", ["turtlesim_py", "turtlesim_challenge", "grader", "grader_robots"]
)
def test_each_package_has_a_manifest_with_its_name_and_version(package):
    manifest = Path(sys.prefix, "share", package, "package.xml").read_text()
    assert f"<name>{package}</name>" in manifest
    assert f"<version>{version('turtlesim_py')}</version>" in manifest


@without_ros
def test_a_tf2_is_installed_module_by_module():
    for package in ("tf2_py", "tf2_ros"):
        ours = {path.name for path in (ROOT / "tf2" / package).glob("*.py")}
        installed = Path(sysconfig.get_path("purelib"), package)
        assert {path.name for path in installed.glob("*.py")} == ours
        spec = importlib.util.find_spec(package)
        assert spec and spec.origin == str(installed / "__init__.py")


@without_ros
def test_python_finds_installed_packages_without_any_setup(shell):
    code = "from ament_index_python import get_package_prefix as g; print(g('turtlesim'))"
    env = {name: value for name, value in shell.items() if name != "AMENT_PREFIX_PATH"}
    prefix = ran([sys.executable, "-c", code], env=env)
    assert prefix.stdout.strip() == sys.prefix, prefix.stderr


@without_ros
def test_a_sourced_workspace_goes_before_the_environment(shell):
    code = "import os; print(os.environ['AMENT_PREFIX_PATH'])"
    env = shell | {"AMENT_PREFIX_PATH": "/workspace/install"}
    path = ran([sys.executable, "-c", code], env=env)
    assert path.stdout.strip() == f"/workspace/install{os.pathsep}{sys.prefix}"


#: Imports what students import, and names what of the environment it had to compile.
PROBE = f"""\
import sys
import math, random, threading, time
from enum import Enum
import numpy, rclpy, yaml
import rclpy.action, rclpy.callback_groups, rclpy.duration, rclpy.executors, rclpy.parameter
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import Odometry, Path
from rclpy.qos import QoSProfile
from sensor_msgs.msg import JointState, LaserScan
from std_msgs.msg import String
from std_srvs.srv import Empty
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Color, Pose
from turtlesim.srv import SetPen, Spawn
import tf2_ros

import os
from importlib.util import MAGIC_NUMBER, cache_from_source

def is_compiled(path):
    try:
        with open(cache_from_source(path), "rb") as file:
            head = file.read(16)
    except OSError:
        return False
    stat = os.stat(path)
    numbers = (0, int(stat.st_mtime) & 0xFFFFFFFF, stat.st_size & 0xFFFFFFFF)
    return head == MAGIC_NUMBER + b"".join(number.to_bytes(4, "little") for number in numbers)

files = [getattr(module, "__file__", None) or "" for module in list(sys.modules.values())]
files = [path for path in files if path.startswith({sys.prefix!r}) and path.endswith(".py")]
main = "/student/virtual_main.py"
print("looked at", len(files), "compiled", [
    path for path in files if not path.endswith(main) and not is_compiled(path)
])
"""


@without_ros
def test_a_confined_run_compiles_no_module_of_the_environment(shell, tmp_path):
    (tmp_path / "probe.py").write_text(PROBE)
    grader = Path(sys.prefix, "bin", "grader")
    env = {name: value for name, value in shell.items() if name != "PYTHONPATH"}
    subprocess.run(
        [grader, "run", "probe.py", "--out", "out"], cwd=tmp_path, env=env, capture_output=True
    )
    (line,) = (tmp_path / "out" / "output.txt").read_text().splitlines()
    assert re.fullmatch(r"looked at \d{3,} compiled \[\]", line)
