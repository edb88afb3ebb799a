"""`colcon build` with ROS sourced: nothing is compiled, and nothing of ROS comes from PyPI.

No ROS is needed for it: `ROS_DISTRO` is what tells, and rclpy comes from this Python's packages.
"""

import os
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.programs import ran

from .conftest import ROOT, Environment, colcon_build
from .rosdep import KEYS, hide_all_but

pytestmark = pytest.mark.more("builds with colcon, in three ways")


@dataclass(frozen=True)
class Workspace:
    install: Path
    env: Environment  # as after `source install/setup.bash`

    @property
    def installed(self) -> list[Path]:
        return [path for path in self.install.rglob("*") if path.is_file()]


@pytest.fixture(params=["", "--merge-install", "--symlink-install"], scope="module")
def workspace(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("workspace")
    # whoever asks for a package from somewhere fails
    nowhere = dict.fromkeys(("http_proxy", "https_proxy"), "http://127.0.0.1:9")
    words = ["--base-paths", ROOT, *filter(None, [request.param])]
    build = colcon_build(folder, *words, ROS_DISTRO="jazzy", PIP_NO_INDEX="1", **nowhere)
    assert build.returncode == 0, build.stdout + build.stderr
    return Workspace(folder / "install", sourced(folder / "install" / "setup.bash"))


def sourced(script: Path) -> Environment:
    """The environment of a shell that has sourced `script`."""
    env = {name: value for name, value in os.environ.items() if name != "AMENT_PREFIX_PATH"}
    lines = ran(["bash", "-c", 'source "$1" && env -0', "-", script], env=env)
    assert lines.returncode == 0, lines.stderr
    return dict(line.split("=", 1) for line in lines.stdout.split("\0") if line)


def test_programs_run_from_the_workspace(workspace, ros2_run, run_until_started, shell):
    env = workspace.env | {"ROS_DOMAIN_ID": shell["ROS_DOMAIN_ID"]}
    for package, program in (
        ("turtlesim_challenge", "turtle_controller"),
        ("grader", "grader"),
        ("grader_robots", "robot_state_publisher"),
        ("turtlesim_py", "turtlesim_node"),
    ):
        assert ros2_run(package, program, env).is_relative_to(workspace.install)
    assert "Starting turtlesim" in run_until_started(
        ros2_run("turtlesim_py", "turtlesim_node", env), env
    )


def test_the_grader_starts_with_what_rosdep_gets_from_apt(workspace, ros2_run, tmp_path):
    program = ros2_run("grader", "grader", workspace.env)
    apt = [name for name, key in KEYS.items() if not key.endswith("-pip")]
    hiding = str(hide_all_but(tmp_path / "hiding", apt))
    path = os.pathsep.join([hiding, workspace.env["PYTHONPATH"]])
    env = workspace.env | {"PYTHONPATH": path, "ROS_DISTRO": "jazzy"}
    for arguments in (["--help"], ["run", "--help"], ["new", "my_solution"]):
        call = ran([program, *arguments], cwd=tmp_path, env=env)
        assert call.returncode == 0, call.stderr
    assert (tmp_path / "my_solution" / "package.xml").exists()


def test_python_imports_from_the_workspace(workspace):
    code = "import turtlesim_py, turtlesim; print(turtlesim_py.__file__, turtlesim.__file__)"
    files = ran([sys.executable, "-P", "-c", code], env=workspace.env)
    ours, interfaces = map(Path, files.stdout.split())
    assert ours.is_relative_to(workspace.install.parent)
    assert not interfaces.is_relative_to(workspace.install.parent)


def test_the_tf2_of_ros_is_not_hidden(workspace):
    """Neither by what is installed, nor by a checkout that stands on Python's path."""
    ours = {"tf2_py", "tf2_ros", "tf2_msgs"}
    assert [path for path in workspace.installed if not ours.isdisjoint(path.parts)] == []
    code = "import tf2_py, tf2_ros, tf2_msgs; print(tf2_py, tf2_ros, tf2_msgs)"
    found = ran([sys.executable, "-c", code], cwd=ROOT, env=workspace.env)
    assert found.stdout.count("<module") == 3, found.stderr
    assert f"{ROOT}/tf2/" not in found.stdout


def test_launch_file_is_where_ros2_launch_looks(workspace):
    folders = {path.parent for path in workspace.installed if path.parent.name == "launch"}
    shared = [folder for folder in folders if folder.parents[1].name == "share"]
    names = [path.name for path in workspace.installed if path.parent in shared]
    assert sorted(names) == ["multisim.launch.py", "turtlesim_challenge.launch.py"]


def test_nothing_of_ros_is_built_or_required(workspace):
    assert [path for path in workspace.installed if path.suffix in (".so", ".pth")] == []
    requirements = [path for path in workspace.installed if path.name == "requires.txt"]
    # an --symlink-install leaves them in the build folder
    for path in requirements or workspace.install.parent.rglob("requires.txt"):
        assert "numpy" in path.read_text()
        assert "ros-" not in path.read_text()
