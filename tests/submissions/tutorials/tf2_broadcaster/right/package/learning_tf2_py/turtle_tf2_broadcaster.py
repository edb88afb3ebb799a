import math

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from tf2_ros import TransformBroadcaster
from turtlesim.msg import Pose


class Broadcaster(Node):
    def __init__(self):
        super().__init__('turtle_tf2_frame_publisher')
        self.turtlename = self.declare_parameter('turtlename', 'turtle').value
        self.tf = TransformBroadcaster(self)
        self.create_subscription(Pose, f'/{self.turtlename}/pose', self.on_pose, 1)

    def on_pose(self, pose):
        message = TransformStamped()
        message.header.stamp = self.get_clock().now().to_msg()
        message.header.frame_id = 'world'
        message.child_frame_id = self.turtlename
        message.transform.translation.x = pose.x
        message.transform.translation.y = pose.y
        message.transform.rotation.z = math.sin(pose.theta / 2)
        message.transform.rotation.w = math.cos(pose.theta / 2)
        self.tf.sendTransform(message)


def main(args=None):
    rclpy.init(args=args)
    try:
        rclpy.spin(Broadcaster())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()
