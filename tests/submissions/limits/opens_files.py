"""Opens a file 3000 times."""

import os

import rclpy

rclpy.init()
node = rclpy.create_node("greedy")
kept = [os.open(__file__, os.O_RDONLY) for _ in range(3000)]
rclpy.spin(node)
