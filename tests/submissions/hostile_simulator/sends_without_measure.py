"""With each pose two hundred messages that nobody hears, as bytes: to make them takes no time."""

import rclpy
from rclpy.serialization import serialize_message
from std_msgs.msg import Bool
from turtlesim.msg import Pose

rclpy.init()
node = rclpy.create_node("controller")
publishers = [node.create_publisher(Bool, f"unheard{number}", 1) for number in range(10)]
data = serialize_message(Bool(data=True))


def flood(_: Pose) -> None:
    for number in range(200):
        publishers[number % 10].publish(data)


node.create_subscription(Pose, "/turtle1/pose", flood, 10)
rclpy.spin(node)
