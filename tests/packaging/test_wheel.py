"""What pip is told to fetch, and what a wheel holds and needs, with ROS sourced and without."""

import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tomllib
import zipfile
from collections.abc import Iterator
from email import message_from_string
from importlib.metadata import Distribution
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from .conftest import ROOT, Environment, RunNode


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


@pytest.mark.parametrize(
    ("ros", "rclpy", "generator"),
    [
        ("jazzy", "ros-jazzy-rclpy[fastrtps]==7.1.6", "ros-rosidl-generator-py==0.22.2"),
        ("kilted", "ros-kilted-rclpy[fastrtps]==9.1.2", "ros-rosidl-generator-py==0.24.2"),
    ],
)
def test_without_ros_it_comes_from_pypi(
    checkout: Path, shell: Environment, ros: str, rclpy: str, generator: str
) -> None:
    shell.pop("ROS_DISTRO", None)
    asked = requirements(checkout, shell | {"ROS": ros})
    assert rclpy in asked["run"]
    assert generator in asked["build"]
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
    packages = ("turtlesim_py", "turtlesim_challenge", "robot_py", "grader", "grader_robots")
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
    assert [name for name in names if name.startswith("tf2")] == []
    for node in ("robot_state_publisher", "joint_state_publisher"):
        assert [name for name in names if f"/data/lib/{node}/" in name] == []
        assert [name for name in names if name.endswith(f"/packages/{node}")] == []


@pytest.mark.more("builds two wheels")
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


@pytest.mark.more("builds two wheels")
def test_a_deleted_module_is_not_in_the_next_wheel(
    checkout: Path, ros_sourced: Environment
) -> None:
    module = checkout / "grader" / "deleted_later.py"
    module.touch()
    assert "grader/deleted_later.py" in wheel_names(checkout, ros_sourced)
    module.unlink()
    assert "grader/deleted_later.py" not in wheel_names(checkout, ros_sourced)


def test_every_program_is_where_ros2_run_looks(checkout: Path, ros_sourced: Environment) -> None:
    scripts = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]
    expected = {f"lib/{re.split('[.:]', function)[0]}/{name}" for name, function in scripts.items()}
    name = call_hook(checkout, ros_sourced, "build_wheel", checkout.parent)
    with zipfile.ZipFile(checkout.parent / name) as wheel:
        found = {
            entry.filename.partition("/data/")[2]: entry
            for entry in wheel.infolist()
            if "/data/lib/" in entry.filename
        }
        assert found.keys() == expected
        assert {wheel.read(entry).splitlines()[0] for entry in found.values()} == {b"#!/bin/sh"}
    assert {entry.external_attr >> 16 & 0o777 for entry in found.values()} == {0o755}


def test_all_packages_have_one_version() -> None:
    versions = {
        path: ElementTree.parse(ROOT / path).findtext("version")
        for path in (
            "package.xml",
            "grader/package.xml",
            "turtlesim_challenge/package.xml",
            "robot_py/package.xml",
            "grader_robots/package.xml",
        )
    }
    ours = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]
    assert versions == dict.fromkeys(versions, ours)
    assert f"turtlesim_py-{ours}+jazzy-" in (ROOT / "docs" / "your-machine.md").read_text()


@pytest.fixture
def no_compiler(shell: Environment) -> Environment:
    """Nothing on the path, and the variables that name compilers lead nowhere."""
    shell.pop("ROS_DISTRO", None)
    return shell | {"PATH": "/nonexistent", "CC": "/nonexistent/gcc", "CXX": "/nonexistent/g++"}


MISSING = "Cannot install: missing: /nonexistent/gcc, /nonexistent/g++ (Debian, Ubuntu: sudo apt"


def test_without_a_compiler_pip_shows_one_line(checkout: Path, no_compiler: Environment) -> None:
    # no environment for the build, as for `make install`: another one comes from the index
    pip = [sys.executable, "-m", "pip", "install", "--no-deps", "--no-build-isolation"]
    call = subprocess.run(
        [*pip, "--target", checkout.parent / "target", checkout],
        env=no_compiler,
        capture_output=True,
        text=True,
    )
    assert call.returncode != 0
    said = call.stdout + call.stderr
    assert "[1 lines of output]" in said
    (line,) = [line for line in said.splitlines() if "Cannot install" in line]
    assert line.strip().startswith(MISSING)


def test_without_a_compiler_nothing_is_downloaded(checkout: Path, no_compiler: Environment) -> None:
    code = "from setuptools import build_meta; build_meta.get_requires_for_build_wheel()"
    call = subprocess.run(
        [sys.executable, "-c", code], cwd=checkout, env=no_compiler, capture_output=True, text=True
    )
    assert call.returncode != 0
    (line,) = call.stderr.splitlines()
    assert line.startswith(MISSING)


@pytest.mark.parametrize("arguments", [["--help"], ["sdist", "--help"], ["--version"]])
def test_what_compiles_nothing_needs_no_compiler(
    checkout: Path, no_compiler: Environment, arguments: list[str]
) -> None:
    setup = [sys.executable, "setup.py", *arguments]
    call = subprocess.run(setup, cwd=checkout, env=no_compiler, capture_output=True, text=True)
    assert call.returncode == 0, call.stderr


def test_each_ros_has_a_build_folder_of_its_own(checkout: Path, shell: Environment) -> None:
    shell.pop("ROS_DISTRO", None)
    code = (
        "import runpy, setuptools; "
        "setuptools.setup = lambda options, **_: print(options['build']['build_base']); "
        "runpy.run_path('setup.py')"
    )
    folders = [
        subprocess.run(
            [sys.executable, "-c", code],
            cwd=checkout,
            env=shell | {"ROS": ros},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for ros in ("jazzy", "kilted")
    ]
    assert folders == ["build/jazzy\n", "build/kilted\n"]


@pytest.fixture
def requirements_only(tmp_path: Path) -> Iterator[Path]:
    """An environment with all that a wheel requires: links to this one, without this project."""
    place = tmp_path / "environment"
    # not the one that a build has left in this checkout
    site = [sysconfig.get_path("purelib")]
    (installed,) = Distribution.discover(name="turtlesim_py", path=site)
    ours = {Path(str(file.locate())).resolve() for file in installed.files or ()}

    def leave_out(folder: str, names: list[str]) -> set[str]:
        return {name for name in names if Path(folder, name).resolve() in ours}

    shutil.copytree(sys.prefix, place, symlinks=True, ignore=leave_out, copy_function=os.symlink)
    assert not (place / "bin" / "grader").exists()
    yield place
    shutil.rmtree(place)  # ten thousands of links, which pytest would keep


@pytest.mark.skipif("ROS_DISTRO" in os.environ, reason="nothing is compiled there")
@pytest.mark.more("compiles; test_install looks at what is installed")
@pytest.mark.timeout(300)
def test_a_wheel_needs_no_compiler(
    checkout: Path,
    shell: Environment,
    no_compiler: Environment,
    requirements_only: Path,
    tmp_path: Path,
    run_until_started: RunNode,
) -> None:
    wheel = tmp_path / call_hook(checkout, shell, "build_wheel", tmp_path)
    place = requirements_only
    bare = no_compiler | {"PATH": str(place / "bin"), "VIRTUAL_ENV": str(place)}
    bare.pop("AMENT_PREFIX_PATH", None)  # that of this Python

    def call(program: str, *arguments: str | Path) -> str:
        command = [place / "bin" / program, *arguments]
        done = subprocess.run(command, env=bare, cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    call("python", "-m", "pip", "install", "--no-deps", "--no-index", wheel)
    found = call("python", "-c", "import turtlesim.msg as m, grader as g; print(m, g)")
    assert found.count(str(place)) == 2
    assert "Starting turtlesim" in run_until_started(place / "bin" / "turtlesim_node", bare)
    call("grader", "new", "mine")
    call("grader", "run", "mine", "--out", "graded")
    assert (tmp_path / "graded" / "result.json").is_file()
