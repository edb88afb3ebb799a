"""Say once where a frame is. Fill in the two TODOs."""

import sys

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from tf2_ros import StaticTransformBroadcaster  # noqa: F401  you will need it


class StaticBroadcaster(Node):
    """Sends the transform from world to a frame."""

    def __init__(self, arguments):
        super().__init__("static_turtle_tf2_broadcaster")
        child, *numbers = arguments
        x, y, z, roll, pitch, yaw = map(float, numbers)
        transform = TransformStamped()
        transform.header.stamp = self.get_clock().now().to_msg()
        # TODO 1: fill in header.frame_id, which is world, child_frame_id, and transform: its
        #         translation, and its rotation, a quaternion (x, y, z, w) of roll, pitch and yaw.
        # TODO 2: send it with a StaticTransformBroadcaster.


def main():
    """Run the node until Ctrl-C."""
    rclpy.init()
    try:
        rclpy.spin(StaticBroadcaster(sys.argv[1:8]))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
