"""Checks of this system: submissions run on Linux, and are judged and shown anywhere."""

from __future__ import annotations

import os
import sys
from pathlib import Path

#: Where Linux shows its processes.
PROC = Path("/proc")


def is_ros_sourced() -> bool:
    """Whether ROS comes from the user's shell rather than from PyPI."""
    return "ROS_DISTRO" in os.environ


def runs_submissions() -> bool:
    """Whether this is Linux, with its processes shown in /proc."""
    return sys.platform == "linux" and (PROC / "self" / "stat").exists()
