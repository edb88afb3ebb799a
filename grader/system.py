"""What this system has: submissions are run on Linux, and judged and shown anywhere."""

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


def user() -> str:
    """What tells this user's files from those of others."""
    return str(os.getuid()) if hasattr(os, "getuid") else os.environ.get("USERNAME", "user")


def is_own(found: os.stat_result) -> bool:
    """Whether a file is this user's; Windows keeps such things in lists that are not looked at."""
    return not hasattr(os, "geteuid") or found.st_uid == os.geteuid()


def owner(found: os.stat_result) -> str:
    """Whose a file is, for a message: a name, or else a number."""
    try:
        import pwd  # here, since Windows lacks it

        return pwd.getpwuid(found.st_uid).pw_name
    except (ImportError, KeyError):
        return f"user {found.st_uid}"
