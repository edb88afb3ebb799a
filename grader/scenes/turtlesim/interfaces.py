"""Which package a submission takes turtlesim's messages from, and texts for the other one.

ROS 2 has them in `turtlesim` up to Jazzy, in `turtlesim_msgs` from Kilted on
(`turtlesim_py.ros.interfaces`); one node serves one of them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from grader.errors import SubmissionError
from turtlesim_py.ros.interfaces import NAMES, NEWER, OLDER, installed, of_release, usual

#: The package's name where Python imports it and where a package.xml depends on it.
_NAMED = re.compile(
    rf"(?<![\w.])({OLDER}|{NEWER})(?=\.(msg|srv|action)\b)"
    rf"|(?<=from )({OLDER}|{NEWER})(?= import (msg|srv|action)\b)"
    rf"|(?<=depend>)({OLDER}|{NEWER})(?=</)"
)


def choose(surely: Mapping[str, str], perhaps: Mapping[str, str]) -> str:
    """The package that a submission imports, whenever it is run or perhaps; else the usual one.

    One that is not installed here is not chosen: the submission then fails with its import, as it
    does in every ROS that is like this one.

    Raises:
        SubmissionError: it surely imports both.
    """
    if surely.keys() >= set(NAMES):
        raise SubmissionError(
            f"The submission imports both {OLDER} ({surely[OLDER]}) and {NEWER} ({surely[NEWER]}), "
            f"but no ROS 2 has both: keep {OLDER} for Jazzy and older releases, {NEWER} for Kilted "
            "and newer ones."
        )
    there = installed()
    return next((name for name in (*surely, *perhaps) if name in there), usual())


def adapted(text: str, ros_distro: str) -> str:
    """A Python file or a package.xml with the package that a ROS 2 release has."""
    return _NAMED.sub(of_release(ros_distro), text)
