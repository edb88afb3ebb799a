"""This system: whether submissions can run on it, which they do on Linux, and its versions."""

from __future__ import annotations

import importlib.util
import os
import re
import sys
from pathlib import Path

#: Where Linux shows its processes.
PROC = Path("/proc")
#: Stands for an unknown version.
UNKNOWN = "?"


def is_ros_sourced() -> bool:
    """Whether ROS comes from the user's shell rather than from PyPI."""
    return "ROS_DISTRO" in os.environ


def runs_submissions() -> bool:
    """Whether this is Linux, with its processes shown in /proc."""
    return sys.platform == "linux" and (PROC / "self" / "stat").exists()


def grader_version() -> str:
    """Return the version of the grader."""
    return _of_distribution("turtlesim_py") or UNKNOWN


def python_version() -> str:
    return ".".join(map(str, sys.version_info[:3]))


def rclpy_version() -> str:
    """Return the version of the installed rclpy, without importing it."""
    # from PyPI; its package.xml may say less
    if found := _of_distribution("ros-rclpy"):
        return found
    try:
        spec = importlib.util.find_spec("rclpy")
        # prefix/lib/pythonX.Y/site-packages/rclpy/__init__.py
        prefix = Path(str(spec and spec.origin)).parents[4]
        text = (prefix / "share" / "rclpy" / "package.xml").read_text(encoding="utf-8")
    except (OSError, IndexError, ValueError):
        return UNKNOWN
    version = re.search(r"<version>([\w.+-]+)</version>", text)
    return version[1] if version else UNKNOWN


def ros_distro() -> str:
    """Return the name of the ROS 2 release that is sourced; '' where none is."""
    return os.environ.get("ROS_DISTRO", "")


def _of_distribution(name: str) -> str:
    """Return the version of an installed distribution; '' where it is missing."""
    from importlib import metadata  # costs 15 ms, and is not needed by every process

    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return ""
