"""What pip is told to fetch, and what a wheel holds and needs, with ROS sourced and without.

That it installs and works in an empty environment, scripts/release.sh proves.
"""

import json
import re
import sys
import tempfile
import tomllib
import zipfile
from email import message_from_string
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from interfaces.build import PACKAGES
from tests.programs import ran

from .conftest import ROOT, Environment

pytestmark = pytest.mark.more("builds wheels; test_install_script.py has what is installed when")
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
RELEASES = ("jazzy", "kilted")


def call_hook(checkout: Path, env: Environment, name: str, *arguments: Path) -> Any:
    """What one of setuptools' build hooks returns, in the folder of a setup.py, as pip calls it."""
    code = (
        "import json, sys; from setuptools import build_meta; _, name, *arguments = sys.argv; "
        "print('\\n' + json.dumps(getattr(build_meta, name)(*arguments)))"
    )
    call = ran([sys.executable, "-c", code, name, *arguments], cwd=checkout, env=env)
    assert call.returncode == 0, call.stderr
    return json.loads(call.stdout.splitlines()[-1])


def requirements(checkout: Path, env: Environment) -> dict[str, list[str]]:
    """What a build asks for, and what the installed package asks for."""
    out = Path(tempfile.mkdtemp(dir=checkout))
    folder = call_hook(checkout, env, "prepare_metadata_for_build_wheel", out)
    metadata = message_from_string((out / folder / "METADATA").read_text())
    return {
        "build": call_hook(checkout, env, "get_requires_for_build_wheel"),
        "run": metadata.get_all("Requires-Dist", []),
    }


def built(checkout: Path, env: Environment) -> zipfile.ZipFile:
    """A wheel."""
    name = call_hook(checkout, env, "build_wheel", checkout.parent)
    return zipfile.ZipFile(checkout.parent / name)


@pytest.fixture
def ros_sourced(shell):
    return shell | {"ROS_DISTRO": "jazzy"}


@pytest.fixture
def none_sourced(shell):
    return {name: value for name, value in shell.items() if name != "ROS_DISTRO"}


@pytest.mark.parametrize(
    ("ros", "rclpy", "generator"),
    [
        ("jazzy", "ros-jazzy-rclpy[fastrtps]==7.1.6", "ros-rosidl-generator-py==0.22.2"),
        ("kilted", "ros-kilted-rclpy[fastrtps]==9.1.2", "ros-rosidl-generator-py==0.24.2"),
    ],
)
def test_what_an_extra_brings_is_of_one_release_of_ros(
    checkout, none_sourced, ros, rclpy, generator
):
    asked = requirements(checkout / "interfaces" / ros, none_sourced)
    assert rclpy in asked["run"]
    assert generator in asked["build"]
    of_ros = [name for name in asked["run"] + asked["build"] if name.startswith("ros-")]
    assert [name for name in of_ros if "==" not in name] == []  # later ROS releases share the names


def test_the_project_asks_for_nothing_of_ros_and_for_the_same_everywhere(
    checkout, ros_sourced, none_sourced
):
    asked = requirements(checkout, none_sourced)
    assert requirements(checkout, ros_sourced | {"ROS": "kilted"}) == asked
    assert asked["build"] == []
    assert [name for name in asked["run"] if name.startswith(("ros-", "xacro"))] == []
    assert any(name.startswith("numpy") for name in asked["run"])
    version = PYPROJECT["project"]["version"]
    for release in RELEASES:
        assert f'turtlesim-py-{release}=={version}; extra == "{release}"' in asked["run"]


def test_where_ros_is_sourced_a_second_one_is_refused_in_one_line(checkout, ros_sourced):
    code = "from setuptools import build_meta; build_meta.get_requires_for_build_wheel()"
    folder = checkout / "interfaces" / "jazzy"
    call = ran([sys.executable, "-c", code], cwd=folder, env=ros_sourced)
    assert call.returncode != 0
    (line,) = call.stderr.splitlines()
    assert line.startswith("Cannot install: ROS 2 jazzy is sourced")


def test_every_file_of_the_packages_is_in_the_wheel_and_nothing_that_ros_has(
    checkout, none_sourced
):
    of_ros = ("grader", "grader_robots", "turtlesim_challenge", "turtlesim_py")
    packages = (*of_ros, "grader_class", "grader_diagnosis", "ros_doubles")
    files = {
        path.relative_to(checkout).as_posix()
        for package in packages
        for path in (checkout / package).rglob("*")
        if path.is_file()
    }
    names = built(checkout, none_sourced).namelist()
    assert list(checkout.parent.glob("turtlesim_py-*-py3-none-any.whl"))
    assert files - set(names) == set()
    assert {"grader/py.typed", "turtlesim_py/py.typed"} <= files
    assert [name for name in names if name.endswith((".so", ".pth"))] == []
    top = {name.partition("/")[0] for name in names}
    assert {name for name in top if not name.startswith("turtlesim_py-")} == {*packages}
    # nor programs and markers of ROS's packages
    data = [name.partition("/data/")[2].split("/") for name in names if "/data/" in name]
    assert {folders[1] for folders in data if folders[0] == "lib"} <= {*of_ros}
    marked = {folders[-1] for folders in data if folders[-2] == "packages"}
    shared = {folders[1] for folders in data if folders[0] == "share"} - {"ament_index"}
    assert marked == shared == {*of_ros}


#: What ROS has by these names, or what stands for it where none is sourced.
OF_ROS = (*PACKAGES, "tf2_py", "tf2_ros")
#: Prints which of these names Python finds, with the finder that a grading's processes have.
FIND = """
import sys
from importlib.util import find_spec
sys.path.insert(0, sys.argv[1])
from grader.ros import uncompiled
from grader.ros.definitions import UncompiledPackages
assert uncompiled.__file__.startswith(sys.argv[1])
sys.meta_path.insert(0, UncompiledPackages())
print([name for name in sys.argv[2:] if find_spec(name)], uncompiled.packages())
"""


def test_where_ros_is_sourced_nothing_of_ours_stands_for_a_package_of_ros(
    checkout, ros_sourced, tmp_path
):
    """As far as Python finds it: this environment's packages and ROS's are out of sight."""
    built(checkout, ros_sourced).extractall(tmp_path / "wheel")
    # what the finder needs of others
    needed = ("numpy", "rosidl_parser", "rosidl_adapter", "rosidl_cli", "em", "lark", "ament_index")
    beside = tmp_path / "beside"
    beside.mkdir()
    for path in (path for folder in sys.path for path in Path(folder).glob("*")):
        if path.name.startswith(needed) and not (beside / path.name).exists():
            (beside / path.name).symlink_to(path)
    call = ran(
        [sys.executable, "-S", "-c", FIND, tmp_path / "wheel", *OF_ROS],
        cwd=tmp_path,
        env=ros_sourced | {"PYTHONPATH": str(beside), "ROS_DISTRO": "jazzy"},
    )
    assert call.stdout == "[] []\n", call.stderr


def test_a_deleted_module_is_not_in_the_next_wheel(checkout, ros_sourced):
    module = checkout / "grader" / "deleted_later.py"
    module.touch()
    assert "grader/deleted_later.py" in built(checkout, ros_sourced).namelist()
    module.unlink()
    assert "grader/deleted_later.py" not in built(checkout, ros_sourced).namelist()


def test_every_program_is_where_ros2_run_looks(checkout, ros_sourced):
    scripts = PYPROJECT["project"]["scripts"]
    expected = {f"lib/{re.split('[.:]', function)[0]}/{name}" for name, function in scripts.items()}
    wheel = built(checkout, ros_sourced)
    found = {
        entry.filename.partition("/data/")[2]: entry
        for entry in wheel.infolist()
        if "/data/lib/" in entry.filename
    }
    assert found.keys() == expected
    assert {wheel.read(entry).splitlines()[0] for entry in found.values()} == {b"#!/bin/sh"}
    assert {entry.external_attr >> 16 & 0o777 for entry in found.values()} == {0o755}


def test_all_packages_have_one_version():
    manifests = [ROOT / "package.xml", *ROOT.glob("*/package.xml")]
    versions = [ElementTree.parse(path).findtext("version") for path in manifests]
    for path in ROOT.glob("interfaces/*/pyproject.toml"):
        versions.append(tomllib.loads(path.read_text())["project"]["version"])
    assert versions == [PYPROJECT["project"]["version"]] * (4 + len(RELEASES))


@pytest.fixture
def no_compiler(shell):
    """Nothing on the path, and the variables that name compilers lead nowhere."""
    shell.pop("ROS_DISTRO", None)
    return shell | {"PATH": "/nonexistent", "CC": "/nonexistent/gcc", "CXX": "/nonexistent/g++"}


def test_the_project_needs_no_compiler(checkout, no_compiler):
    assert built(checkout, no_compiler).filename.endswith("-any.whl")


@pytest.fixture(params=["no_compiler", "none_wanted"])
def uncompiled(request, shell):
    """An environment that compiles nothing."""
    if request.param == "no_compiler":
        return request.getfixturevalue("no_compiler")
    shell.pop("ROS_DISTRO", None)
    return shell | {"COMPILE": ""}


def test_interfaces_that_are_not_compiled_are_installed_as_their_definitions(checkout, uncompiled):
    folder = checkout / "interfaces" / "jazzy"
    assert call_hook(folder, uncompiled, "get_requires_for_build_wheel") == []
    wheel = built(folder, uncompiled)
    assert wheel.filename.endswith("-py3-none-any.whl")
    shared = {name.partition(".data/data/share/")[2] for name in wheel.namelist()}
    modules = {name.partition("/")[0] for name in wheel.namelist()}
    packages = ROOT / "interfaces" / "packages"
    for name, source in PACKAGES.items():
        index = "ament_index/resource_index"
        expected = {f"{name}/package.xml", f"{index}/packages/{name}"}
        definitions = (packages / source).glob("*/*.*")
        expected |= {f"{name}/{path.parent.name}/{path.name}" for path in definitions}
        assert expected | {f"{index}/rosidl_interfaces/{name}"} <= shared
    modules = {name for name in modules if not name.startswith("turtlesim_py_jazzy-")}
    assert modules == {"tf2_py", "tf2_ros", "turtlesim_py_ament_prefix.pth"}


@pytest.mark.parametrize("release", RELEASES)
def test_each_ros_has_a_build_folder_of_its_own(checkout, none_sourced, release):
    code = (
        "import runpy, setuptools; "
        "setuptools.setup = lambda options, **_: print(options['build']['build_base']); "
        "runpy.run_path('setup.py')"
    )
    folder = checkout / "interfaces" / release
    said = ran([sys.executable, "-c", code], cwd=folder, env=none_sourced, check=True).stdout
    assert said == f"../../build/{release}\n"
