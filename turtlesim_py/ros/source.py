"""Where ROS comes from, the user's shell or PyPI; and what to do where neither has it, or both.

Every command asks before it imports anything of ROS. This imports none itself.
"""

from __future__ import annotations

import os
import sys
from importlib.machinery import PathFinder
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from turtlesim_py.ros import interfaces

#: Where interfaces/build.py names each ROS release that it has brought into an environment.
BROUGHT = Path("share", "ament_index", "resource_index", "turtlesim_py_ros")
#: The exit code of a command.
UNUSABLE = 2


class Complaint:
    """Why a command cannot start.

    Args:
        text: a sentence, with {names} for its values.
    """

    def __init__(self, text: str, **values: Any) -> None:
        self.text = text
        self.values = values

    def __str__(self) -> str:
        return self.text.format(**self.values)


def complaint(*, is_virtual: bool = False) -> Complaint | None:
    """Return what is wrong with the ROS that this Python finds, and what to do; None: nothing.

    Args:
        is_virtual: whether messages pass DDS by, which carries those of compiled interfaces alone.
    """
    sourced = os.environ.get("ROS_DISTRO", "")
    brought = _brought()
    if len(brought) > 1:
        return Complaint(
            "several ROS 2 releases were installed into {prefix} ({releases}), where they "
            "overwrite each other: make a new environment for one of them",
            prefix=sys.prefix,
            releases=", ".join(f"turtlesim-py-{release}" for release in brought),
        )
    rclpy = find_spec("rclpy")
    is_there = rclpy is not None and rclpy.origin is not None
    if not is_there and sourced:
        return Complaint(
            "ROS 2 {release} is sourced, but {python} does not find its rclpy: take the Python "
            "that this ROS was built for, or a shell without ROS",
            release=sourced,
            python=sys.executable,
        )
    if not is_there or not (sourced or brought or interfaces.installed()):
        return Complaint(
            "no ROS 2 found: source yours, or install one with {python} -m pip install "
            "'turtlesim_py[jazzy]' (or [kilted]; for Linux x86_64, others: docs/your-machine.md)",
            python=sys.executable,
        )
    assert rclpy is not None and rclpy.origin is not None
    if not PathFinder.find_spec("rclpy._rclpy_pybind11", rclpy.submodule_search_locations):
        return Complaint(
            "the rclpy in {folder} is for another Python than {python} ({version}): take the one "
            "that this ROS was built for, or a shell without ROS",
            folder=Path(rclpy.origin).parent,
            python=sys.executable,
            version=_version(),
        )
    if brought and not Path(rclpy.origin).is_relative_to(sys.prefix):
        return Complaint(
            "two ROS 2 found, which do not go together: the sourced one has rclpy in {folder}, and "
            "turtlesim-py-{release} has brought another into {prefix}. Take a shell without ROS, "
            "or an environment without turtlesim-py-{release}",
            folder=Path(rclpy.origin).parent,
            release=brought[0],
            prefix=sys.prefix,
        )
    if not (is_virtual or sourced or interfaces.installed()):
        return Complaint(
            "turtlesim's interfaces are installed as definitions only, which is enough for "
            "gradings in virtual time. For all else install gcc, g++ and Python's headers (Debian, "
            "Ubuntu: sudo apt install build-essential python{version}-dev), then "
            "turtlesim-py-{release} once more (in a checkout: make install)",
            version=_version(),
            release=brought[0],
        )
    return None


def _version() -> str:
    return ".".join(map(str, sys.version_info[:2]))


def _brought() -> list[str]:
    try:
        return sorted(path.name for path in Path(sys.prefix, BROUGHT).iterdir())
    except OSError:
        return []


def complains(command: str) -> bool:
    """Print what is wrong with ROS, if anything is, and return whether that is so."""
    if (found := complaint()) is None:
        return False
    print(f"{command}: {found}", file=sys.stderr)
    return True
