"""Lets one turtle copy another: the original's mimic.

mimic --ros-args -r input/pose:=turtle1/pose -r output/cmd_vel:=turtle2/cmd_vel
"""

from __future__ import annotations

import sys
from typing import Any

from geometry_msgs.msg import Twist

from turtlesim_py.ros import program
from turtlesim_py.ros.rclcpp_node import RclcppNode

#: Printed by --help.
ABOUT = """\
Let one turtle do what another does: the speeds of input/pose become commands on output/cmd_vel.
    mimic --ros-args -r input/pose:=turtle1/pose -r output/cmd_vel:=turtle2/cmd_vel

parameters:
    interfaces       package of the messages: turtlesim or turtlesim_msgs"""


class MimicNode(RclcppNode):
    """The node `/turtle_mimic`: the speeds of `input/pose` become commands on `output/cmd_vel`."""

    def __init__(self) -> None:
        super().__init__("turtle_mimic")
        self._velocity = self.create_publisher(Twist, "output/cmd_vel", 1)
        pose = self.declare_interfaces().msg.Pose
        self.create_subscription(pose, "input/pose", self._on_pose, 1)

    def _on_pose(self, pose: Any) -> None:
        twist = Twist()
        twist.linear.x = pose.linear_velocity
        twist.angular.z = pose.angular_velocity
        self._velocity.publish(twist)


def main(argv: list[str] | None = None) -> int:
    return program.run("mimic", MimicNode, program.spin, argv, ABOUT)


if __name__ == "__main__":
    sys.exit(main())
