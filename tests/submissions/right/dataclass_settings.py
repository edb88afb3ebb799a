"""All numbers in one place."""

from __future__ import annotations

from dataclasses import dataclass

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen


@dataclass(frozen=True)
class Settings:
    period: float = 0.2
    growth: float = 0.1
    turn: float = 2.5
    margin: float = 1.1
    size: float = 11.088889
    width: int = 4


@dataclass
class Color:
    r: int
    g: int
    b: int


COLORS = [Color(255, 255, 255), Color(250, 0, 0), Color(0, 0, 0), Color(0, 250, 0)]


class SettingsNode(Node):
    def __init__(self, settings: Settings) -> None:
        super().__init__("settings_node")
        self.settings = settings
        self.speed: float = 0.0
        self.old_quadrant: int | None = None
        self.stopped: bool = False
        self.publisher = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.client = self.create_client(SetPen, "/turtle1/set_pen")
        self.subscriber = self.create_subscription(Pose, "/turtle1/pose", self.handle_pose, 10)
        self.drive_timer = self.create_timer(self.settings.period, self.drive)

    def drive(self) -> None:
        if self.stopped:
            self.publish_velocity(0.0, 0.0)
            return
        self.speed += self.settings.growth
        self.publish_velocity(self.speed, self.settings.turn)

    def publish_velocity(self, linear: float, angular: float) -> None:
        message = Twist()
        message.linear.x = linear
        message.angular.z = angular
        self.publisher.publish(message)

    def is_near_edge(self, pose: Pose) -> bool:
        low = self.settings.margin
        high = self.settings.size - self.settings.margin
        return pose.x < low or pose.x > high or pose.y < low or pose.y > high

    def quadrant_of(self, pose: Pose) -> int:
        half = self.settings.size / 2
        if pose.y >= half:
            return 0 if pose.x >= half else 1
        return 2 if pose.x < half else 3

    def handle_pose(self, pose: Pose) -> None:
        if not self.stopped and self.is_near_edge(pose):
            self.stopped = True
            self.publish_velocity(0.0, 0.0)
        if self.stopped:
            return
        quadrant = self.quadrant_of(pose)
        if quadrant != self.old_quadrant:
            self.old_quadrant = quadrant
            self.set_color(COLORS[quadrant])

    def set_color(self, color: Color) -> None:
        request = SetPen.Request()
        request.r = color.r
        request.g = color.g
        request.b = color.b
        request.width = self.settings.width
        request.off = 0
        self.client.call_async(request)


def main(args: list[str] | None = None) -> None:
    rclpy.init(args=args)
    node = SettingsNode(Settings())
    rclpy.spin(node)


if __name__ == "__main__":
    main()
