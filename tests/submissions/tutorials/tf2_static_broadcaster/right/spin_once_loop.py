import sys

import numpy as np
import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from tf2_ros import StaticTransformBroadcaster


class Frame:
    """What is to be sent."""

    def __init__(self, name, *numbers):
        self.name = name
        self.xyz = numbers[:3]
        self.rpy = np.array(numbers[3:6]) / 2

    def transform(self, now):
        t = TransformStamped()
        t.header.stamp = now
        t.header.frame_id = "world"
        t.child_frame_id = self.name
        for axis, value in zip("xyz", self.xyz):
            setattr(t.transform.translation, axis, value)
        (sr, sp, sy), (cr, cp, cy) = np.sin(self.rpy), np.cos(self.rpy)
        t.transform.rotation.x = sr * cp * cy - cr * sp * sy
        t.transform.rotation.y = cr * sp * cy + sr * cp * sy
        t.transform.rotation.z = cr * cp * sy - sr * sp * cy
        t.transform.rotation.w = cr * cp * cy + sr * sp * sy
        return t


def main():
    rclpy.init()
    node = Node("static_turtle_tf2_broadcaster")
    frame = Frame(sys.argv[1], *[float(text) for text in sys.argv[2:8]])
    StaticTransformBroadcaster(node).sendTransform(frame.transform(node.get_clock().now().to_msg()))
    try:
        while rclpy.ok():
            rclpy.spin_once(node, timeout_sec=0.5)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
