"""Installs the four packages and, where ROS 2 is not sourced, builds interfaces and adds a tf2.

A sourced ROS (`ROS_DISTRO` is set) has rclpy, tf2 and the interfaces of turtlesim already: then
nothing of ROS is required, nothing compiled, and nothing of ours hides what is there. What is
required stands in pyproject.toml.
"""

import os
import re
import shutil
import sys
import tomllib
from pathlib import Path
from typing import Any

from setuptools import Command, Distribution, find_packages, setup
from setuptools.command.build_py import build_py

# resolved: `colcon build --symlink-install` runs a link to this file, in a folder that lacks most
# of the tree, pyproject.toml too. So the metadata is also given below.
ROOT = Path(__file__).resolve().parent
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
PROJECT = PYPROJECT["project"]
REQUIREMENTS = PYPROJECT["tool"]["turtlesim-py"]
ROS_IS_SOURCED = bool(os.environ.get("ROS_DISTRO"))
# where it is not: which ROS release from PyPI
RELEASE = os.environ.get("ROS") or "jazzy"
ROS = REQUIREMENTS["ros"][RELEASE]
# Commands that compile, or by which pip asks what compiling needs. It asks before it downloads
# anything; later the line about a missing compiler would stand below hundreds of others.
COMPILING = {"egg_info", "dist_info", "bdist_wheel", "editable_wheel", "install", "build"}

# Each is a ROS package of its own, with the files that it launches. turtlesim_py stands last:
# of several destinations of one file, colcon sees the last.
ROS_PACKAGES: dict[str, list[str]] = {
    "grader": [],
    "grader_robots": [],
    "robot_py": [],
    "turtlesim_challenge": ["launch/turtlesim_challenge.launch.py"],
    "turtlesim_py": ["launch/multisim.launch.py"],
}


# Where ROS is not sourced, these too, by the names of ROS's own packages. They lie in a folder of
# their own, so that a checkout on the path of Python hides none of ROS's.
TF2_PACKAGES = ["tf2_py", "tf2_ros"]


class BuildPy(build_py):
    """`build_py` that starts empty, and gives the reference controller the messages there are.

    Empty, because pip keeps build/, and a deleted module would be installed.
    """

    def run(self) -> None:
        """Remove what an earlier build left, then build."""
        for package in (*ROS_PACKAGES, *TF2_PACKAGES):
            shutil.rmtree(Path(self.build_lib) / package, ignore_errors=True)
        super().run()
        reference = Path(self.build_lib) / "turtlesim_challenge" / "turtle_controller.py"
        # from Kilted on; releases are named in the order of the alphabet
        if os.environ.get("ROS_DISTRO", "") >= "kilted" and reference.exists():
            text = reference.read_text(encoding="utf-8")
            text = text.replace("from turtlesim.", "from turtlesim_msgs.")
            reference.write_text(text, encoding="utf-8")


OWN_PACKAGES = find_packages(
    str(ROOT), include=[name for package in ROS_PACKAGES for name in (package, f"{package}.*")]
)


# `ros2 run PACKAGE PROGRAM` starts <prefix>/lib/PACKAGE/PROGRAM. pip and colcon write the same
# program, with the right Python in its first line, to <prefix>/bin: run that one.
RUN_FROM_BIN = '#!/bin/sh\nexec "$(dirname "$0")/../../bin/$(basename "$0")" "$@"\n'
# Data files that the build writes, by the folder that `data_files` names for them: there is none of
# that name in the sources. An empty file in the ament index is how packages are found.
WRITTEN = {"run_from_bin": RUN_FROM_BIN, "ament_marker": ""}


class WriteData(Command):
    """Part of the commands that install data files: writes those which are not in the sources."""

    def copy_file(self, infile: str, outfile: str, **options: Any) -> tuple[str, bool]:
        """Install a data file in the folder `outfile`; return its path there, and True."""
        folder, _, name = infile.partition("/")
        if folder not in WRITTEN:
            return super().copy_file(infile, outfile, **options)
        path = Path(outfile, name)
        path.unlink(missing_ok=True)  # a link of `colcon build --symlink-install` would be followed
        path.write_text(WRITTEN[folder], encoding="utf-8")
        path.chmod(0o755 if folder == "run_from_bin" else 0o644)
        return str(path), True


class RosDistribution(Distribution):
    """A distribution whose data files are partly written by the build.

    Not by `cmdclass`: colcon brings a command of its own, which may not be here.
    """

    def get_command_class(self, command: str) -> type[Command]:
        """Return the class of a command."""
        found = super().get_command_class(command)
        if command not in ("install_data", "symlink_data"):
            return found
        return type(found.__name__, (WriteData, found), {})


def data_files() -> list[tuple[str, list[str]]]:
    """What `ros2 run`, `ros2 launch` and the ament index look for, below the prefix."""
    index = "share/ament_index/resource_index/packages"
    programs: dict[str, list[str]] = {package: [] for package in ROS_PACKAGES}
    for name, function in PROJECT["scripts"].items():
        programs[re.split(r"[.:]", function)[0]].append(f"run_from_bin/{name}")
    files = []
    if not ROS_IS_SOURCED:
        # `ros2 run turtlesim turtlesim_node`, as every tutorial has it. A sourced ROS has its own
        files += [
            ("share/turtlesim/launch", ROS_PACKAGES["turtlesim_py"]),
            ("lib/turtlesim", programs["turtlesim_py"]),
        ]
        # likewise the nodes of robots, each in the package of its name
        for path in programs["robot_py"]:
            package = Path(path).name
            files += [(index, [f"ament_marker/{package}"]), (f"lib/{package}", [path])]
    for package, launch_files in ROS_PACKAGES.items():
        manifest = "package.xml" if package == PROJECT["name"] else f"{package}/package.xml"
        files += [
            (index, [f"ament_marker/{package}"]),
            (f"share/{package}", [manifest]),
            (f"share/{package}/launch", launch_files),
            (f"lib/{package}", programs[package]),
        ]
    return [(folder, names) for folder, names in files if names]


def extras() -> dict[str, list[str]]:
    """What each extra requires."""
    found: dict[str, list[str]] = dict(REQUIREMENTS["extras"])
    if not ROS_IS_SOURCED:
        found["robots"] = [*found["robots"], *REQUIREMENTS["robots_without_ros"]]
    return found


def ros_dependent() -> dict[str, Any]:
    """The arguments of setup() that differ where ROS is sourced."""
    if ROS_IS_SOURCED:
        return {
            "install_requires": REQUIREMENTS["dependencies"],
            "cmdclass": {"build_py": BuildPy},
            "packages": OWN_PACKAGES,
        }
    sys.path.insert(0, str(ROOT))
    from grader.rosidl.compiler import complaint
    from interfaces.build import BuildInterfaces, extensions

    if COMPILING.intersection(sys.argv) and (line := complaint()):
        sys.exit(line)
    return {
        "install_requires": [*REQUIREMENTS["dependencies"], *ROS["run"]],
        "setup_requires": ROS["build"],
        "ext_modules": extensions(),
        "packages": [*OWN_PACKAGES, *TF2_PACKAGES],
        "package_dir": {name: f"tf2/{name}" for name in TF2_PACKAGES},
        "cmdclass": {"build_py": BuildPy, "build_ext": BuildInterfaces},
        # what is compiled for one release of ROS is not for another
        "options": {"build": {"build_base": f"build/{RELEASE}"}},
    }


setup(
    name=PROJECT["name"],
    version=PROJECT["version"],
    license="BSD-3-Clause",
    python_requires=">=3.11",
    # Everything in the four packages. Not by MANIFEST.in (include_package_data): setuptools then
    # warns about the starter, a package that is not to be imported
    package_data={package: ["**/*", "**/.*"] for package in ROS_PACKAGES},
    exclude_package_data={package: ["*.py[cod]"] for package in ROS_PACKAGES},
    include_package_data=False,
    data_files=data_files(),
    distclass=RosDistribution,
    entry_points={
        group: [f"{name} = {where}" for name, where in points.items()]
        for group, points in {
            "console_scripts": PROJECT["scripts"],
            **PROJECT["entry-points"],
        }.items()
    },
    extras_require=extras(),
    zip_safe=False,
    **ros_dependent(),
)
