"""ROS, and packages that only part of the grader needs: what is missing is said in one line.

pip installs all packages, the extra `cluster` only on request. `rosdep install` installs what
Ubuntu has; the rest is for pip, which refuses to change Ubuntu's Python without a flag.
"""

from __future__ import annotations

import importlib
import sys
from importlib.util import find_spec

from grader.errors import GraderFailure, UsageError
from grader.text.message import msg
from turtlesim_py.ros import source

#: The module to import, its use, and the requirement for pip, with the bounds of pyproject.toml.
OPTIONAL = {
    "backports.zstd": (
        "backports.zstd",
        msg("recordings are compressed with it"),
        "backports.zstd>=1",
    ),
    "distributed": (
        "distributed",
        msg("--scheduler speaks to a dask cluster with it"),
        "distributed>=2025.1.0",
    ),
    "websockets": (
        "websockets",
        msg("--live serves a page with it"),
        "websockets>=14,<18",
    ),
}


def require(package: str, load: bool = True) -> None:
    """Check that a package can be imported, before anything that needs it.

    Args:
        package: one of `OPTIONAL`.
        load: import it; else only search for it, which costs no time.
    """
    module, use, requirement = OPTIONAL[package]
    try:
        if load:
            importlib.import_module(module)
        elif find_spec(package) is None:
            raise ImportError(name=package)
    except ImportError as error:
        found = error.name or package
        is_package = found.partition(".")[0] == package.partition(".")[0]
        missing = (
            package
            if is_package
            else msg("{found}, which {package} needs,", found=found, package=package)
        )
        raise GraderFailure(
            "the Python package {missing} is missing ({use}). Install it with: "
            "{executable} -m pip install '{requirement}' (in a system's own Python,"
            " where pip refuses that, with --break-system-packages)",
            missing=missing,
            use=use,
            executable=sys.executable,
            requirement=requirement,
        ) from None


def missing_ros(time: str = "virtual") -> UsageError | None:
    """Return what is wrong with ROS here and what to do; None where nothing is.

    Args:
        time: the clock of a grading: `virtual` or `real`.
    """
    found = source.complaint(is_virtual=time == "virtual")
    return UsageError(found.text, **found.values) if found else None


def require_ros(time: str = "virtual") -> None:
    """Check that ROS can be imported, before anything that needs it."""
    if error := missing_ros(time):
        raise error
