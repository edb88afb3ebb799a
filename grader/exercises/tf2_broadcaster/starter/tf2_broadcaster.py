"""Say where a turtle is, as a frame. Fill in the three TODOs."""

import math  # noqa: F401  you will need it

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from tf2_ros import TransformBroadcaster
from turtlesim.msg import Pose


class TurtleFrame(Node):
    """Hears a turtle's pose, sends its frame."""

    def __init__(self):
        super().__init__("turtle_tf2_frame_publisher")
        self.turtle = "turtle1"  # TODO 1: declare the parameter turtlename, and take its value.
        self.broadcaster = TransformBroadcaster(self)
        # TODO 2: create a subscription to the turtle's pose, /turtle1/pose for turtle1, that calls
        #         send().

    def send(self, pose: Pose):
        """Called with each pose: x, y and theta."""
        transform = TransformStamped()
        transform.header.stamp = self.get_clock().now().to_msg()
        # TODO 3: fill in header.frame_id, which is world, child_frame_id, which is the turtle's
        #         name, and transform: its translation, and its rotation, a quaternion. Of a turn by
        #         theta about z it is z = sin(theta / 2), w = cos(theta / 2).
        self.broadcaster.sendTransform(transform)


def main(args=None):
    """Run the node until Ctrl-C."""
    rclpy.init(args=args)
    try:
        rclpy.spin(TurtleFrame())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
