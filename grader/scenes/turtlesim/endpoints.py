"""What turtlesim's node publishes, listens to and serves, by name and type."""

from __future__ import annotations

from collections.abc import Sequence

from grader.scenes.scene import Endpoint
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from turtlesim_py.ros.interfaces import OLDER

#: Of so many turtles; nobody mistakes a name for one of more.
_MOST_TURTLES = 20


def endpoints(trace: TurtleTrace, interfaces: str) -> Sequence[Endpoint]:
    """Those of the turtles, the first turtle's first, then the node's.

    Args:
        interfaces: the package whose messages the run had; '' for the usual one.
    """
    package = interfaces or OLDER
    others = [turtle for turtle in trace.trajectories if turtle != FIRST_TURTLE]
    found = []
    for turtle in (FIRST_TURTLE, *others[: _MOST_TURTLES - 1]):
        found += [
            Endpoint("subscription", f"/{turtle}/cmd_vel", "geometry_msgs/msg/Twist"),
            Endpoint("publisher", f"/{turtle}/pose", f"{package}/msg/Pose"),
            Endpoint("publisher", f"/{turtle}/color_sensor", f"{package}/msg/Color"),
            Endpoint("service", f"/{turtle}/set_pen", f"{package}/srv/SetPen"),
            *(
                Endpoint("service", f"/{turtle}/{name}", f"{package}/srv/{kind}")
                for name, kind in (
                    ("teleport_absolute", "TeleportAbsolute"),
                    ("teleport_relative", "TeleportRelative"),
                )
            ),
            Endpoint("action", f"/{turtle}/rotate_absolute", f"{package}/action/RotateAbsolute"),
        ]
    return [
        *found,
        Endpoint("service", "/clear", "std_srvs/srv/Empty"),
        Endpoint("service", "/reset", "std_srvs/srv/Empty"),
        Endpoint("service", "/spawn", f"{package}/srv/Spawn"),
        Endpoint("service", "/kill", f"{package}/srv/Kill"),
    ]
