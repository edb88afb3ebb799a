"""Publishes on /tf without a broadcaster."""

import math

import rclpy
from geometry_msgs.msg import Quaternion, Transform, TransformStamped, Vector3
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage
from turtlesim.msg import Pose


class FramePublisher(Node):
    def __init__(self):
        super().__init__("turtle_tf2_frame_publisher")
        self.declare_parameter("turtlename", "turtle1")
        self.turtle = self.get_parameter("turtlename").value
        self.pub = self.create_publisher(TFMessage, "/tf", 100)
        self.create_subscription(Pose, f"{self.turtle}/pose", self.on_pose, 10)

    def on_pose(self, pose):
        half = pose.theta / 2
        self.pub.publish(
            TFMessage(
                transforms=[
                    TransformStamped(
                        header=Header(stamp=self.get_clock().now().to_msg(), frame_id="world"),
                        child_frame_id=self.turtle,
                        transform=Transform(
                            translation=Vector3(x=pose.x, y=pose.y),
                            rotation=Quaternion(z=math.sin(half), w=math.cos(half)),
                        ),
                    )
                ]
            )
        )


def main():
    rclpy.init()
    try:
        rclpy.spin(FramePublisher())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
