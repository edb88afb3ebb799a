"""Let turtle1 draw a square again and again: the original's draw_square."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import Twist
from std_srvs.srv import Empty

from turtlesim_py.ros import program
from turtlesim_py.ros.rclcpp_node import RclcppNode
from turtlesim_py.world.turtle import Pose

#: Printed by --help.
ABOUT = """\
Reset the simulator, then let turtle1 draw a square of 2 m again and again. A turtlesim_node has to
be running.

parameters:
    interfaces       package of the messages: turtlesim or turtlesim_msgs"""
#: The square's side [m].
SIDE_M = 2.0
#: How fast it goes ahead [m/s] and turns [rad/s].
SPEED = 1.0
TURN_RATE = 0.4
#: A goal is reached this near to it [m, m, rad].
NEAR_M = 0.1
NEAR_RAD = 0.01
#: What still counts as standing still [m/s, rad/s].
STILL = 0.0001
#: Between two commands [s]: a tick of the simulator.
PERIOD_S = 0.016
#: A server that has not discovered the client yet loses its answer: the request is repeated after
#: this many periods.
ANSWERED_WITHIN = 125


class Square:
    """Decides the next command: ahead, stop, turn, stop, and so on.

    Attributes:
        corners: how many sides it has finished.
        on_goal: called with each new goal, x, y [m], theta [rad].
    """

    def __init__(self, on_goal: Callable[[float, float, float], None]) -> None:
        self.corners = 0
        self.on_goal = on_goal
        self._goal: tuple[float, float, float] | None = None
        self._turning = False
        self._stopping = False

    def command(self, pose: Pose) -> tuple[float, float]:
        """Speed ahead [m/s] and rate of turn [rad/s] for a turtle that is here."""
        if self._goal is None:
            self._go_ahead(pose)
        elif self._stopping and abs(pose.linear_velocity) + abs(pose.angular_velocity) < STILL:
            self._stopping = False
            if self._turning:
                self._go_ahead(pose)
            else:
                self._turn(pose)
        if self._stopping or self._has_arrived(pose):
            self._stopping = True
            return 0.0, 0.0
        return (0.0, TURN_RATE) if self._turning else (SPEED, 0.0)

    def _go_ahead(self, pose: Pose) -> None:
        self._turning = False
        x = pose.x + math.cos(pose.theta) * SIDE_M
        y = pose.y + math.sin(pose.theta) * SIDE_M
        self._set_goal(x, y, pose.theta)

    def _turn(self, pose: Pose) -> None:
        self._turning = True
        self.corners += 1
        quarter = pose.theta + math.pi / 2
        self._set_goal(pose.x, pose.y, math.remainder(quarter, 2 * math.pi))

    def _set_goal(self, x: float, y: float, theta: float) -> None:
        self._goal = x, y, theta
        self.on_goal(x, y, theta)

    def _has_arrived(self, pose: Pose) -> bool:
        assert self._goal is not None
        x, y, theta = self._goal
        off_rad = math.remainder(pose.theta - theta, 2 * math.pi)
        near = abs(pose.x - x) < NEAR_M and abs(pose.y - y) < NEAR_M
        return near and abs(off_rad) < NEAR_RAD


class DrawSquare(RclcppNode):
    """The node `/draw_square`: resets the simulator, then drives turtle1."""

    def __init__(self) -> None:
        super().__init__("draw_square")
        self._pose: Pose | None = None
        self._waited = 0
        self._ready = False
        self._square = Square(self._log_goal)
        self._velocity = self.create_publisher(Twist, "turtle1/cmd_vel", 1)
        self._reset = self.create_client(Empty, "reset")
        pose = self.declare_interfaces().msg.Pose
        self.create_subscription(pose, "turtle1/pose", self._on_pose, 1)
        self.create_timer(PERIOD_S, self._on_timer)

    def _on_pose(self, pose: Pose) -> None:
        self._pose = pose

    def _on_timer(self) -> None:
        if self._ready and self._pose is not None:
            twist = Twist()
            twist.linear.x, twist.angular.z = self._square.command(self._pose)
            self._velocity.publish(twist)
        elif not self._ready and self._reset.service_is_ready():
            if self._waited % ANSWERED_WITHIN == 0:
                self._reset.call_async(Empty.Request()).add_done_callback(self._on_reset)
            self._waited += 1

    def _on_reset(self, _: Any) -> None:
        self._pose = None  # it was the old turtle's
        self._ready = True

    def _log_goal(self, x: float, y: float, theta: float) -> None:
        self.get_logger().info(f"New goal [{x:f} {y:f}, {theta:f}]")


def main(argv: list[str] | None = None) -> int:
    return program.run("draw_square", DrawSquare, program.spin, argv, ABOUT)


if __name__ == "__main__":
    sys.exit(main())
