"""Asks for 3 GiB at once, and touches none of it."""

import rclpy

rclpy.init()
node = rclpy.create_node("greedy")
kept = bytearray(3 << 30)
rclpy.spin(node)
