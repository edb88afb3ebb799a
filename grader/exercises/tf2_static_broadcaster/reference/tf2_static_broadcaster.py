"""Say once where a frame is."""

import math
import sys

import rclpy
from geometry_msgs.msg import Quaternion, TransformStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from tf2_ros import StaticTransformBroadcaster


def quaternion(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return a rotation about x, then y, then z, as a quaternion."""
    (sr, cr), (sp, cp), (sy, cy) = (
        (math.sin(angle / 2), math.cos(angle / 2)) for angle in (roll, pitch, yaw)
    )
    return Quaternion(
        x=sr * cp * cy - cr * sp * sy,
        y=cr * sp * cy + sr * cp * sy,
        z=cr * cp * sy - sr * sp * cy,
        w=cr * cp * cy + sr * sp * sy,
    )


class StaticBroadcaster(Node):
    """Sends the transform from world to a frame."""

    def __init__(self, arguments):
        super().__init__("static_turtle_tf2_broadcaster")
        child, *numbers = arguments
        x, y, z, roll, pitch, yaw = map(float, numbers)
        transform = TransformStamped(child_frame_id=child)
        transform.header.stamp = self.get_clock().now().to_msg()
        transform.header.frame_id = "world"
        place = transform.transform.translation
        place.x, place.y, place.z = x, y, z
        transform.transform.rotation = quaternion(roll, pitch, yaw)
        self.broadcaster = StaticTransformBroadcaster(self)
        self.broadcaster.sendTransform(transform)


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
