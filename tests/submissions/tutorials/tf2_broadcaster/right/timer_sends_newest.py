"""Keeps the newest pose, and sends it 50 times a second."""

import math

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from tf2_ros.transform_broadcaster import TransformBroadcaster
from turtlesim.msg import Pose


class FramePublisher(Node):
    def __init__(self):
        super().__init__("turtle_tf2_frame_publisher")
        self.turtle = self.declare_parameter("turtlename", "turtle1").value
        self.pose = None
        self.broadcaster = TransformBroadcaster(self)
        group = ReentrantCallbackGroup()
        self.create_subscription(
            Pose, f"/{self.turtle}/pose", self.keep, 10, callback_group=group
        )
        self.create_timer(0.02, self.send, callback_group=group)

    def keep(self, pose):
        self.pose = pose

    def send(self):
        pose = self.pose
        if pose is None:
            return
        t = TransformStamped()
        t.header.stamp = self.get_clock().now().to_msg()
        t.header.frame_id = "world"
        t.child_frame_id = self.turtle
        t.transform.translation.x = pose.x
        t.transform.translation.y = pose.y
        t.transform.rotation.z = math.sin(pose.theta / 2.0)
        t.transform.rotation.w = math.cos(pose.theta / 2.0)
        self.broadcaster.sendTransform(t)


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(FramePublisher())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
