"""With each pose ten messages of two megabytes that nobody hears."""

import rclpy
from rclpy.serialization import serialize_message
from std_msgs.msg import String
from turtlesim.msg import Pose

rclpy.init()
node = rclpy.create_node("controller")
publisher = node.create_publisher(String, "unheard", 1)
data = serialize_message(String(data="x" * 2_000_000))


def flood(_: Pose) -> None:
    for _ in range(10):
        publisher.publish(data)


node.create_subscription(Pose, "/turtle1/pose", flood, 10)
rclpy.spin(node)
