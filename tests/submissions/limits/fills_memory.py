"""Fills 1.5 GiB, a little at a time, and keeps it."""

import rclpy

rclpy.init()
node = rclpy.create_node("greedy")
kept = [b"x" * (4 << 20) for _ in range(384)]
rclpy.spin(node)
