"""Sends from a timer, once, and several threads spin."""

import math
import sys

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from tf2_ros import StaticTransformBroadcaster


class StaticFrame(Node):
    def __init__(self, name, numbers):
        super().__init__("static_turtle_tf2_broadcaster")
        self.name, self.numbers = name, numbers
        self.broadcaster = StaticTransformBroadcaster(self)
        self.timer = self.create_timer(0.1, self.send)

    def send(self):
        self.timer.cancel()
        x, y, z, *angles = self.numbers
        (sr, cr), (sp, cp), (sy, cy) = ((math.sin(a / 2), math.cos(a / 2)) for a in angles)
        t = TransformStamped()
        t.header.stamp = self.get_clock().now().to_msg()
        t.header.frame_id = "world"
        t.child_frame_id = self.name
        t.transform.translation.x = x
        t.transform.translation.y = y
        t.transform.translation.z = z
        t.transform.rotation.x = sr * cp * cy - cr * sp * sy
        t.transform.rotation.y = cr * sp * cy + sr * cp * sy
        t.transform.rotation.z = cr * cp * sy - sr * sp * cy
        t.transform.rotation.w = cr * cp * cy + sr * sp * sy
        self.broadcaster.sendTransform([t])
        self.get_logger().info(f"Sent {self.name}")


def main(args=None):
    rclpy.init(args=args)
    own = rclpy.utilities.remove_ros_args(sys.argv)
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(StaticFrame(own[1], [float(text) for text in own[2:8]]))
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
