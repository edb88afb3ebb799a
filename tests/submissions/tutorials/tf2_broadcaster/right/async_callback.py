import math

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from tf2_ros import TransformBroadcaster
from turtlesim.msg import Pose


class FramePublisher(Node):
    def __init__(self):
        super().__init__("turtle_tf2_frame_publisher")
        self.declare_parameter("turtlename", "turtle1")
        self.turtle = self.get_parameter("turtlename").get_parameter_value().string_value
        self.broadcaster = TransformBroadcaster(self)
        self.create_subscription(Pose, f"/{self.turtle}/pose", self.on_pose, 10)

    async def on_pose(self, pose):
        self.broadcaster.sendTransform(await self.transform(pose))

    async def transform(self, pose):
        t = TransformStamped(child_frame_id=self.turtle)
        t.header.stamp = self.get_clock().now().to_msg()
        t.header.frame_id = "world"
        t.transform.translation.x, t.transform.translation.y = pose.x, pose.y
        t.transform.rotation.z = math.sin(pose.theta / 2)
        t.transform.rotation.w = math.cos(pose.theta / 2)
        return t


rclpy.init()
try:
    rclpy.spin(FramePublisher())
except (KeyboardInterrupt, ExternalShutdownException):
    pass
