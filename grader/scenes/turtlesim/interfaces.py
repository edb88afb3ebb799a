"""The endpoints of turtlesim's node, and the package that its messages come from.

ROS 2 has them in `turtlesim` up to Jazzy, in `turtlesim_msgs` from Kilted on
(`turtlesim_py.ros.interfaces`); one node serves one of them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from grader.errors import SubmissionError
from grader.recording.subject import Endpoint
from grader.ros import uncompiled
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from turtlesim_py.ros.interfaces import NAMES, NEWER, OLDER, installed, of_release, usual

#: The package's name in an import of Python and in a dependency of a package.xml.
_NAMED = re.compile(
    rf"(?<![\w.])({OLDER}|{NEWER})(?=\.(msg|srv|action)\b)"
    rf"|(?<=from )({OLDER}|{NEWER})(?= import (msg|srv|action)\b)"
    rf"|(?<=depend>)({OLDER}|{NEWER})(?=</)"
)


def choose(surely: Mapping[str, str], perhaps: Mapping[str, str]) -> str:
    """Return the package that a submission imports, always or perhaps; else the usual one.

    A package that is not installed is not chosen: the import then fails, as in every ROS like this.
    """
    if surely.keys() >= set(NAMES):
        raise SubmissionError(
            f"The submission imports both {OLDER} ({surely[OLDER]}) and {NEWER} ({surely[NEWER]}), "
            f"but no ROS 2 has both: keep {OLDER} for Jazzy and older releases, {NEWER} for Kilted "
            "and newer ones."
        )
    there = {*installed(), *uncompiled.packages()}
    return next((name for name in (*surely, *perhaps) if name in there), usual())


def adapted(text: str, ros_distro: str) -> str:
    """Return a Python file or a package.xml with the package that a ROS 2 release has."""
    return _NAMED.sub(of_release(ros_distro), text)


#: Endpoints of at most so many turtles are listed: enough to recognise a wrong name.
_MOST_TURTLES = 20
#: By their names below a turtle's, or the root; {} is the package of messages.
_OF_A_TURTLE = (
    Endpoint("subscription", "/cmd_vel", "geometry_msgs/msg/Twist"),
    Endpoint("publisher", "/pose", "{}/msg/Pose"),
    Endpoint("publisher", "/color_sensor", "{}/msg/Color"),
    Endpoint("service", "/set_pen", "{}/srv/SetPen"),
    Endpoint("service", "/teleport_absolute", "{}/srv/TeleportAbsolute"),
    Endpoint("service", "/teleport_relative", "{}/srv/TeleportRelative"),
    Endpoint("action", "/rotate_absolute", "{}/action/RotateAbsolute"),
)
_OF_THE_NODE = (
    Endpoint("service", "/clear", "std_srvs/srv/Empty"),
    Endpoint("service", "/reset", "std_srvs/srv/Empty"),
    Endpoint("service", "/spawn", "{}/srv/Spawn"),
    Endpoint("service", "/kill", "{}/srv/Kill"),
)


def endpoints_of(trace: TurtleTrace, interfaces: str) -> Sequence[Endpoint]:
    """Return the endpoints of the turtles, the first turtle's first, then those of the node.

    Args:
        interfaces: the package whose messages the run had; '' for the usual one.
    """
    package = interfaces or OLDER
    others = [turtle for turtle in trace.trajectories if turtle != FIRST_TURTLE]
    found = [
        each._replace(name=f"/{turtle}{each.name}")
        for turtle in (FIRST_TURTLE, *others[: _MOST_TURTLES - 1])
        for each in _OF_A_TURTLE
    ]
    return [each._replace(type=each.type.format(package)) for each in (*found, *_OF_THE_NODE)]
