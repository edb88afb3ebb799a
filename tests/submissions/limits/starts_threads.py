"""Starts 400 threads."""

import threading

import rclpy

rclpy.init()
node = rclpy.create_node("greedy")
end = threading.Event()
for _ in range(400):
    threading.Thread(target=end.wait, daemon=True).start()
rclpy.spin(node)
