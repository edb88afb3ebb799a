"""Prints 20 MB."""

import rclpy

rclpy.init()
node = rclpy.create_node("greedy")
for number in range(20_000):
    print(f"{number:06}", "x" * 992)
rclpy.shutdown()
