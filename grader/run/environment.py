"""The environment variables of a run: nothing of the user's that changes ROS or Python."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

#: Variables that change how ROS or Python works: the user's are not for graded runs ...
PERSONAL = (
    *("CYCLONEDDS_", "FASTDDS_", "FASTRTPS_", "RCL_", "RCUTILS_", "RMW_", "ROS_"),
    *("PYTHON", "PYTEST_"),  # pytest's changes with every test
)
#: ... but for those that tell which ROS there is.
KEPT = ("ROS_DISTRO", "ROS_PYTHON_CHECK_FIELDS", "ROS_PYTHON_VERSION", "ROS_VERSION")


def lasting_environment() -> dict[str, str]:
    """What is the same in all runs, and all that Python and libraries look at where they start."""
    env = {
        name: value
        for name, value in os.environ.items()
        if name in KEPT or not name.startswith(PERSONAL)
    }
    if is_ros_sourced() and "PYTHONPATH" in os.environ:
        env["PYTHONPATH"] = os.environ["PYTHONPATH"]  # ROS's own packages are there
    return {
        **env,
        "SKIP_DEFAULT_XML": "1",  # Fast DDS reads no profile that lies in the current folder
        "LC_ALL": "C.UTF-8",
        "PYTHONUTF8": "1",
        "PYTHONUNBUFFERED": "1",
        "PYTHONDONTWRITEBYTECODE": "1",
        "OPENBLAS_NUM_THREADS": "1",  # numpy's would spin a while, and have nothing to do
    }


def environment(folder: Path, isolated: Mapping[str, str]) -> dict[str, str]:
    """Environment variables for both processes of a run: nothing of the user's that changes it.

    Args:
        folder: where ROS may log, and temporary files go.
        isolated: what the isolation adds.
    """
    (folder / "tmp").mkdir()
    return {
        **lasting_environment(),
        **isolated,
        "ROS_LOG_DIR": str(folder / "log"),
        "TMPDIR": str(folder / "tmp"),
    }


def student_environment(env: Mapping[str, str]) -> dict[str, str]:
    """In virtual time a submission's sets have the same order every time."""
    return {**env, "PYTHONHASHSEED": "0"}


def is_ros_sourced() -> bool:
    """Whether ROS comes from the user's shell rather than from PyPI."""
    return "ROS_DISTRO" in os.environ


def simulator_environment(env: Mapping[str, str]) -> dict[str, str]:
    """The simulator finds our own packages first, and nothing that lies about."""
    ours = str(Path(__file__).resolve().parents[2])
    path = os.pathsep.join(filter(None, [ours, env.get("PYTHONPATH", "")]))
    return {**env, "PYTHONPATH": path, "PYTHONSAFEPATH": "1"}
