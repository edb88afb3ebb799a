"""Logs a page of text a thousand times a second, as long as it lives: 20 MB a second."""

import rclpy

rclpy.init()
node = rclpy.create_node("greedy")
page = "x" * 20_000


def say() -> None:
    node.get_logger().info(page)


node.create_timer(0.001, say)
rclpy.spin(node)
