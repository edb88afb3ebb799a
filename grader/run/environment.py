"""The environment variables of a run: of the user's only those that Python and ROS need.

The environment of a grader may hold tokens (that of a CI job does), which are none of a
submission's business, and settings that would change a run. So variables are let through by name,
not kept out.
"""

from __future__ import annotations

import os
import site
from collections.abc import Mapping
from pathlib import Path

from grader.system import versions as system

#: Where programs, libraries and packages are found.
PLACES = (
    *("PATH", "LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "DYLD_FALLBACK_LIBRARY_PATH"),
    *("VIRTUAL_ENV", "CONDA_PREFIX"),
)
#: How times are shown, and what a terminal can do, if a program asks for one.
MANNERS = ("TZ", "TERM")
#: Which ROS there is, and where its packages are; how strict its messages are about their fields.
ROS = (
    *("ROS_DISTRO", "ROS_PYTHON_CHECK_FIELDS", "ROS_PYTHON_VERSION", "ROS_VERSION"),
    *("AMENT_PREFIX_PATH", "COLCON_PREFIX_PATH"),
)
#: ROS's wheels start Python once more, with the path of their libraries, unless this is set.
STARTED_TWICE = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"
KEPT = frozenset((*PLACES, *MANNERS, *ROS, STARTED_TWICE))


def lasting_environment() -> dict[str, str]:
    """Return the variables of all runs: those that Python and libraries read at start."""
    env = {name: value for name, value in os.environ.items() if name in KEPT}
    if system.is_ros_sourced() and "PYTHONPATH" in os.environ:
        env["PYTHONPATH"] = os.environ["PYTHONPATH"]  # ROS's own packages are there
    if site.ENABLE_USER_SITE:
        # Python searches packages below HOME, which is another in a run
        env["PYTHONUSERBASE"] = site.getuserbase()
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
    """Return the variables for both processes of a run: nothing of the user's that changes it.

    Args:
        folder: where ROS may log, temporary files go, and programs keep their user's files.
        isolated: the variables that the isolation adds.
    """
    (folder / "tmp").mkdir()
    (folder / "home").mkdir()
    return {
        **lasting_environment(),
        **isolated,
        "HOME": str(folder / "home"),
        "ROS_LOG_DIR": str(folder / "log"),
        "TMPDIR": str(folder / "tmp"),
    }


def student_environment(env: Mapping[str, str]) -> dict[str, str]:
    """Return the variables of a submission: its messages check their fields.

    Up to ROS 2 Humble all messages did; later ones do so only if asked. Without the check,
    `linear.x = 2`, an int where a float belongs, is sent as 1e-323 by the wheels of Jazzy, and
    aborts the process where rclpy's assertions in C are compiled in; 256 in an uint8 becomes 0.
    Each message module reads this at its import, so a fork server has to have it as well.
    """
    return {**env, "ROS_PYTHON_CHECK_FIELDS": "1"}


def virtual_environment(env: Mapping[str, str]) -> dict[str, str]:
    """Return the variables of a submission in virtual time: sets have the same order every time."""
    return {**student_environment(env), "PYTHONHASHSEED": "0"}


def simulator_environment(env: Mapping[str, str]) -> dict[str, str]:
    """Return the variables of the simulator: our packages come first, the current folder never."""
    ours = str(Path(__file__).resolve().parents[2])
    path = os.pathsep.join(filter(None, [ours, env.get("PYTHONPATH", "")]))
    return {**env, "PYTHONPATH": path, "PYTHONSAFEPATH": "1"}
