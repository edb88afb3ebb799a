"""Writes 200 MB into one temporary file."""

import tempfile

import rclpy

rclpy.init()
node = rclpy.create_node("greedy")
with tempfile.TemporaryFile() as file:
    for _ in range(200):
        file.write(bytes(1_000_000))
rclpy.spin(node)
