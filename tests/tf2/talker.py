"""A robot as the tutorials write one: sends transforms until it is stopped."""

from contextlib import suppress

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from tf2_ros import StaticTransformBroadcaster, TransformBroadcaster


class Talker(Node):
    def __init__(self) -> None:
        super().__init__("talker")
        laser = TransformStamped()
        laser.header.stamp = self.get_clock().now().to_msg()
        laser.header.frame_id, laser.child_frame_id = "base", "laser"
        laser.transform.translation.z = 0.5
        self.static_broadcaster = StaticTransformBroadcaster(self)
        self.static_broadcaster.sendTransform(laser)
        self.broadcaster = TransformBroadcaster(self)
        self.create_timer(0.02, self.send)

    def send(self) -> None:
        base = TransformStamped()
        base.header.stamp = self.get_clock().now().to_msg()
        base.header.frame_id, base.child_frame_id = "odom", "base"
        base.transform.translation.x = 2.0
        base.transform.rotation.z = base.transform.rotation.w = 0.5**0.5
        self.broadcaster.sendTransform(base)


def main() -> None:
    rclpy.init()
    with suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(Talker())


if __name__ == "__main__":
    main()
