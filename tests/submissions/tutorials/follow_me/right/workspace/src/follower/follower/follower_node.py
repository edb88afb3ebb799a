"""Follows the point that is `gap` metres behind the leader."""
from math import atan2, cos, hypot, pi, sin

import rclpy
from geometry_msgs.msg import Twist
from rclpy.qos import qos_profile_sensor_data
from rclpy.node import Node
from turtlesim.msg import Pose


class Follower(Node):
    def __init__(self):
        super().__init__("follower")
        self.declare_parameters("", [("gap", 1.0), ("k_linear", 1.0), ("k_angular", 1.0)])
        self.leader: Pose | None = None
        self.pub = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Pose, "leader_pose", self.on_leader, qos_profile_sensor_data)
        self.create_subscription(Pose, "pose", self.on_pose, qos_profile_sensor_data)

    def on_leader(self, pose: Pose) -> None:
        self.leader = pose

    def on_pose(self, me: Pose) -> None:
        if not self.leader:
            return
        gap = self.get_parameter("gap").value
        dx = self.leader.x - gap * cos(self.leader.theta) - me.x
        dy = self.leader.y - gap * sin(self.leader.theta) - me.y
        error = atan2(dy, dx) - me.theta
        while error > pi:
            error -= 2 * pi
        while error < -pi:
            error += 2 * pi
        out = Twist()
        if abs(error) < pi / 3:
            out.linear.x = self.get_parameter("k_linear").value * hypot(dx, dy)
        if hypot(dx, dy) > 0.05:
            out.angular.z = self.get_parameter("k_angular").value * error
        self.pub.publish(out)


def main():
    rclpy.init()
    try:
        rclpy.spin(Follower())
    except KeyboardInterrupt:
        pass
