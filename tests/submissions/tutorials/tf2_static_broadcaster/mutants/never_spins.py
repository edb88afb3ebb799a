# In the form of the ROS 2 tutorial's program.
import math
import sys

import numpy as np
import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from tf2_ros.static_transform_broadcaster import StaticTransformBroadcaster


def to_quaternion(roll, pitch, yaw):
    cr, sr = math.cos(roll / 2), math.sin(roll / 2)
    cp, sp = math.cos(pitch / 2), math.sin(pitch / 2)
    cy, sy = math.cos(yaw / 2), math.sin(yaw / 2)

    q = np.zeros(4)
    q[0] = sr * cp * cy - cr * sp * sy
    q[1] = cr * sp * cy + sr * cp * sy
    q[2] = cr * cp * sy - sr * sp * cy
    q[3] = cr * cp * cy + sr * sp * sy
    return q


class StaticTurtleFrame(Node):

    def __init__(self, arguments):
        super().__init__('static_turtle_tf2_broadcaster')
        self.broadcaster = StaticTransformBroadcaster(self)
        self.send(arguments)

    def send(self, arguments):
        frame = TransformStamped()
        frame.header.stamp = self.get_clock().now().to_msg()
        frame.header.frame_id = 'world'
        frame.child_frame_id = arguments[1]

        frame.transform.translation.x = float(arguments[2])
        frame.transform.translation.y = float(arguments[3])
        frame.transform.translation.z = float(arguments[4])

        x, y, z, w = to_quaternion(
            float(arguments[5]), float(arguments[6]), float(arguments[7]))
        frame.transform.rotation.x = x
        frame.transform.rotation.y = y
        frame.transform.rotation.z = z
        frame.transform.rotation.w = w

        self.broadcaster.sendTransform(frame)


def main():
    logger = rclpy.logging.get_logger('static_turtle')
    if len(sys.argv) < 8:
        logger.info('Call it with: child_frame x y z roll pitch yaw')
        sys.exit(1)
    if sys.argv[1] == 'world':
        logger.info('The turtle may not be called "world"')
        sys.exit(2)

    rclpy.init()
    static_turtle_frame = StaticTurtleFrame(sys.argv)
    static_turtle_frame.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
