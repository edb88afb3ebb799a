"""Publishes thousands of messages at once; behind them may be anything."""

import rclpy
from std_msgs.msg import Float64, String

rclpy.init()
node = rclpy.create_node("node")
out = node.create_publisher(Float64, "out", 10)
chatter = node.create_publisher(String, "chatter", 10)
for number in range(3):
    chatter.publish(String(data=f"Hello {number}"))
for _ in range(25_000):
    out.publish(Float64(data=0.0))
chatter.publish(String(data="hidden"))
rclpy.spin(node)
