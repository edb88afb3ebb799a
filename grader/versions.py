"""The versions of the grader, Python, rclpy and ROS, for each result and `grader --version`."""

from __future__ import annotations

import importlib.util
import os
import re
import sys
from pathlib import Path

#: Stands for an unknown version.
UNKNOWN = "?"


def grader() -> str:
    """Return the version of the grader."""
    return _of_distribution("turtlesim_py") or UNKNOWN


def python() -> str:
    """Return the version of Python."""
    return ".".join(map(str, sys.version_info[:3]))


def rclpy() -> str:
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
