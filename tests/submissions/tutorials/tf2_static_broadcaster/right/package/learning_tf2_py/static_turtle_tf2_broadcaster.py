import math
import sys

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from tf2_ros import StaticTransformBroadcaster


class StaticBroadcaster(Node):
    def __init__(self, child, x, y, z, roll, pitch, yaw):
        super().__init__('static_turtle_tf2_broadcaster')
        self.tf = StaticTransformBroadcaster(self)
        message = TransformStamped()
        message.header.stamp = self.get_clock().now().to_msg()
        message.header.frame_id = 'world'
        message.child_frame_id = child
        message.transform.translation.x = x
        message.transform.translation.y = y
        message.transform.translation.z = z
        sr, cr = math.sin(roll / 2), math.cos(roll / 2)
        sp, cp = math.sin(pitch / 2), math.cos(pitch / 2)
        sy, cy = math.sin(yaw / 2), math.cos(yaw / 2)
        message.transform.rotation.x = sr * cp * cy - cr * sp * sy
        message.transform.rotation.y = cr * sp * cy + sr * cp * sy
        message.transform.rotation.z = cr * cp * sy - sr * sp * cy
        message.transform.rotation.w = cr * cp * cy + sr * sp * sy
        self.tf.sendTransform(message)


def main(args=None):
    rclpy.init(args=args)
    node = StaticBroadcaster(sys.argv[1], *(float(number) for number in sys.argv[2:8]))
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
