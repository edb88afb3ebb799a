"""Where ROS is missing, or is there twice, every command says so in one line."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.tiers import others_are_more
from turtlesim_py.ros import source

ROOT = Path(__file__).parents[3]
pytestmark = pytest.mark.applies("ROS_DISTRO" not in os.environ, reason="imitates machines without")
#: Starts Python as if it had only these folders, and no package of ROS.
WITHOUT_ROS = """\
import sys
from importlib.machinery import PathFinder

class WithoutRos(PathFinder):
    @classmethod
    def find_spec(cls, name, path=None, target=None):
        if name.partition(".")[0] in ("rclpy", "turtlesim", "turtlesim_msgs"):
            return None
        return super().find_spec(name, path, target)

sys.meta_path[:] = [each for each in sys.meta_path if each is not PathFinder] + [WithoutRos]
sys.argv[0] = "command"
"""


def call(code, *arguments, folder, shim=WITHOUT_ROS, **env):
    return subprocess.run(
        [sys.executable, "-P", "-c", shim + code, *arguments],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT), "LANGUAGE": "en"} | env,
        capture_output=True,
        text=True,
    )


GRADER = "from grader.__main__ import main; main()"


ROBOT = "import grader_robots.robot_py.commands as c; sys.exit(c.robot_state_publisher())"
COMMANDS = [
    ("turtlesim_node", "import turtlesim_py.commands as c; sys.exit(c.turtlesim_node())", []),
    ("turtle_controller", "import turtlesim_challenge as c; c.main()", []),
    ("grader run", GRADER, ["run", "x.py"]),
    ("robot_state_publisher", ROBOT, []),
    ("grader batch", GRADER, ["batch", "x", "--out", "y"]),
    ("grader check-exercise", GRADER, ["check-exercise", "talker"]),
]


@pytest.mark.parametrize(
    ("command", "code", "arguments"),
    others_are_more("they begin as these do", COMMANDS, *(name for name, *_ in COMMANDS[:3])),
)
def test_without_ros_a_command_says_which_extra_brings_it(command, code, arguments, tmp_path):
    done = call(code, *arguments, folder=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"{command}: no ROS 2 found: ")
    assert f"{sys.executable} -m pip install 'turtlesim_py[jazzy]'" in line


UNCOMPILED = WITHOUT_ROS.replace('("rclpy", ', "(")


@pytest.mark.parametrize(
    ("command", "code", "arguments"),
    [
        ("mimic", "import turtlesim_py.commands as c; sys.exit(c.mimic())", []),
        ("grader run", GRADER, ["run", "x.py", "--time", "real"]),
        ("grader batch", GRADER, ["batch", "x", "--out", "y", "--time", "real"]),
    ],
)
def test_what_needs_compiled_interfaces_says_so(command, code, arguments, tmp_path):
    done = call(code, *arguments, folder=tmp_path, shim=UNCOMPILED)
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"{command}: turtlesim's interfaces are installed as definitions only")
    assert f"python3.{sys.version_info.minor}-dev" in line
    assert f"turtlesim-py-{source._brought()[0]} once more" in line


def test_a_grading_in_virtual_time_needs_none(tmp_path):
    done = call(GRADER, "run", "x.py", folder=tmp_path, shim=UNCOMPILED)
    assert "x.py" in done.stderr
    assert "interfaces" not in done.stderr


def test_what_needs_no_ros_does_without(tmp_path):
    assert call(GRADER, "new", "mine", folder=tmp_path).returncode == 0
    assert (tmp_path / "mine" / "package.xml").is_file()


def test_the_line_stands_in_the_error_file_and_in_the_language_of_the_call(tmp_path):
    done = call(GRADER, "run", "x", "--error-json", "e", "--lang", "fr", folder=tmp_path)
    assert (done.returncode, len(done.stderr.splitlines())) == (2, 1)
    assert "pas de ROS 2 ici" in done.stderr
    assert '"call"' in (tmp_path / "e").read_text()


def test_a_sourced_ros_that_this_python_does_not_find(tmp_path):
    done = call(GRADER, "run", "x", folder=tmp_path, ROS_DISTRO="jazzy")
    assert done.returncode == 2
    assert "ROS 2 jazzy is sourced, but" in done.stderr


@pytest.fixture
def prefix(tmp_path, monkeypatch):
    """Another environment, into which releases of ROS have been installed."""
    monkeypatch.setattr(sys, "prefix", str(tmp_path / "environment"))
    return tmp_path / "environment" / source.BROUGHT


def test_ros_of_this_environment_is_fine():
    assert source.complaint() is None


def test_a_ros_from_elsewhere_or_a_second_release_beside_that_of_the_environment(
    prefix, monkeypatch
):
    monkeypatch.setenv("ROS_DISTRO", "jazzy")
    assert source.complaint() is None
    prefix.mkdir(parents=True)
    (prefix / "jazzy").touch()
    assert "two ROS 2 found" in str(source.complaint())
    monkeypatch.delenv("ROS_DISTRO")
    (prefix / "kilted").touch()
    assert "(turtlesim-py-jazzy, turtlesim-py-kilted)" in str(source.complaint())


def test_an_rclpy_for_another_python(tmp_path, monkeypatch):
    package = tmp_path / "rclpy"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "_rclpy_pybind11.cpython-38-x86_64-linux-gnu.so").touch()
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "rclpy", raising=False)
    monkeypatch.setenv("ROS_DISTRO", "foxy")
    assert f"the rclpy in {package} is for another Python" in str(source.complaint())


def test_the_releases_that_are_looked_for_are_those_that_are_installed():
    text = (ROOT / "interfaces" / "build.py").read_text(encoding="utf-8")
    assert f'BROUGHT = "{source.BROUGHT.as_posix()}"' in text
