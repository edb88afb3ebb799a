"""Publishes megabytes; behind them may be anything."""

import rclpy
from std_msgs.msg import Float64MultiArray, String

rclpy.init()
node = rclpy.create_node("node")
chatter = node.create_publisher(String, "chatter", 10)
big = node.create_publisher(Float64MultiArray, "big", 10)
for number in range(3):
    chatter.publish(String(data=f"Hello {number}"))
for _ in range(8):
    chatter.publish(String(data="x" * 5_000_000))
    big.publish(Float64MultiArray(data=[1.5] * 240_000))
    node.get_logger().info("x" * 1_000_000)
chatter.publish(String(data="hidden"))
rclpy.spin(node)
