"""A timer that is to fire before it is made: only rclpy's C++ notices."""

import rclpy

rclpy.init()
node = rclpy.create_node("controller")
node.create_timer(-0.1, print)
