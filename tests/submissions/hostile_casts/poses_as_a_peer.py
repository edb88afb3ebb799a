"""Has the name of a peer, and says what the peer would say, and what it is to say itself."""

import rclpy
from std_msgs.msg import Float64, String

rclpy.init()
node = rclpy.create_node("peer")
data = node.create_publisher(Float64, "data", 10)
out = node.create_publisher(Float64, "out", 10)
chatter = node.create_publisher(String, "chatter", 10)


def say():
    data.publish(Float64(data=0.0))
    out.publish(Float64(data=0.0))
    chatter.publish(String(data="hidden"))
    node.get_logger().info("I heard: 0.0")


node.create_timer(0.1, say)
rclpy.spin(node)
