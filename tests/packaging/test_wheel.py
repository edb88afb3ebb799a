"""What pip is told to fetch, and what a wheel holds, with ROS sourced and without."""

import json
import subprocess
import sys
import tomllib
import zipfile
from email import message_from_string
from pathlib import Path
from typing import Any

import pytest

from .conftest import ROOT, Environment


def call_hook(checkout: Path, env: Environment, name: str, *arguments: Path) -> Any:
    """What one of setuptools' build hooks returns: pip calls them in this way."""
    code = (
        "import json, sys; from setuptools import build_meta; _, name, *arguments = sys.argv; "
        "print('\\n' + json.dumps(getattr(build_meta, name)(*arguments)))"
    )
    call = subprocess.run(
        [sys.executable, "-c", code, name, *arguments],
        cwd=checkout,
        env=env,
        capture_output=True,
        text=True,
    )
    assert call.returncode == 0, call.stderr
    return json.loads(call.stdout.splitlines()[-1])


def requirements(checkout: Path, env: Environment) -> dict[str, list[str]]:
    """What a build asks for, and what the installed package asks for."""
    folder = call_hook(checkout, env, "prepare_metadata_for_build_wheel", checkout.parent)
    metadata = message_from_string((checkout.parent / folder / "METADATA").read_text())
    return {
        "build": call_hook(checkout, env, "get_requires_for_build_wheel"),
        "run": metadata.get_all("Requires-Dist", []),
    }


def wheel_names(checkout: Path, env: Environment) -> list[str]:
    """Build a wheel, and list what is in it."""
    name = call_hook(checkout, env, "build_wheel", checkout.parent)
    with zipfile.ZipFile(checkout.parent / name) as wheel:
        return wheel.namelist()


@pytest.fixture
def ros_sourced(shell: Environment) -> Environment:
    return shell | {"ROS_DISTRO": "jazzy"}


def test_without_ros_it_comes_from_pypi(checkout: Path, shell: Environment) -> None:
    shell.pop("ROS_DISTRO", None)
    asked = requirements(checkout, shell)
    assert "ros-jazzy-rclpy[fastrtps]==7.1.6" in asked["run"]
    assert "ros-rosidl-generator-py==0.22.2" in asked["build"]
    ros = [name for name in asked["run"] + asked["build"] if name.startswith("ros-")]
    assert [name for name in ros if "==" not in name] == []  # later ROS releases share the names


def test_with_ros_sourced_nothing_of_it_comes_from_pypi(
    checkout: Path, ros_sourced: Environment
) -> None:
    asked = requirements(checkout, ros_sourced)
    assert asked["build"] == []
    assert [name for name in asked["run"] if name.startswith("ros-")] == []
    assert any(name.startswith("numpy") for name in asked["run"])


def test_every_file_of_the_packages_is_in_the_wheel(
    checkout: Path, ros_sourced: Environment
) -> None:
    packages = ("turtlesim_py", "turtlesim_challenge", "grader")
    files = {
        path.relative_to(checkout).as_posix()
        for package in packages
        for path in (checkout / package).rglob("*")
        if path.is_file()
    }
    names = wheel_names(checkout, ros_sourced)
    assert files - set(names) == set()
    assert {"grader/py.typed", "turtlesim_py/py.typed"} <= files
    assert [name for name in names if name.endswith(".so")] == []
    # nor the programs of an ament package turtlesim, which that ROS has itself
    assert [name for name in names if "/data/lib/turtlesim/" in name] == []
    assert [name for name in names if "/data/share/turtlesim/" in name] == []


@pytest.mark.parametrize(
    ("release", "expected"), [("jazzy", "turtlesim"), ("kilted", "turtlesim_msgs")]
)
def test_the_reference_takes_the_messages_that_the_sourced_ros_has(
    checkout: Path, ros_sourced: Environment, release: str, expected: str
) -> None:
    call_hook(checkout, ros_sourced | {"ROS_DISTRO": release}, "build_wheel", checkout.parent)
    (wheel,) = checkout.parent.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        text = archive.read("turtlesim_challenge/turtle_controller.py").decode()
    assert f"from {expected}.msg import Pose" in text
    assert f"from {expected}.srv import SetPen" in text


def test_a_deleted_module_is_not_in_the_next_wheel(
    checkout: Path, ros_sourced: Environment
) -> None:
    module = checkout / "grader" / "deleted_later.py"
    module.touch()
    assert "grader/deleted_later.py" in wheel_names(checkout, ros_sourced)
    module.unlink()
    assert "grader/deleted_later.py" not in wheel_names(checkout, ros_sourced)


def test_every_program_can_be_found_by_ros2_run(checkout: Path) -> None:
    scripts = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]
    assert {path.name for path in (checkout / "ros2run").glob("*") if path.is_symlink()} == set(
        scripts
    )
