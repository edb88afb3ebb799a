# In the form of the ROS 2 tutorial's program.
import math

import numpy as np
import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from tf2_ros import TransformBroadcaster
from turtlesim.msg import Pose


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


class TurtleFrames(Node):

    def __init__(self):
        super().__init__('turtle_tf2_frame_publisher')

        parameter = self.declare_parameter('turtlename', 'turtle')
        self.name = parameter.get_parameter_value().string_value

        self.broadcaster = TransformBroadcaster(self)
        self.poses = self.create_subscription(Pose, f'/{self.name}/pose', self.on_pose, 1)

    def on_pose(self, pose):
        frame = TransformStamped()
        frame.header.stamp = self.get_clock().now().to_msg()
        frame.header.frame_id = 'world'
        frame.child_frame_id = self.name

        frame.transform.translation.x = pose.x
        frame.transform.translation.y = pose.y

        x, y, z, w = to_quaternion(pose.theta, 0, 0)
        frame.transform.rotation.x = x
        frame.transform.rotation.y = y
        frame.transform.rotation.z = z
        frame.transform.rotation.w = w

        self.broadcaster.sendTransform(frame)


def main():
    rclpy.init()
    turtle_frames = TurtleFrames()
    try:
        rclpy.spin(turtle_frames)
    except KeyboardInterrupt:
        pass

    rclpy.shutdown()


if __name__ == '__main__':
    main()
