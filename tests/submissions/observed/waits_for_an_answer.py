"""Asks a service that nobody has, and spins until it has answered, while a timer goes on."""

import rclpy
from turtlesim.srv import SetPen

rclpy.init()
node = rclpy.create_node("controller")
node.create_timer(0.1, lambda: None)
pen = node.create_client(SetPen, "/set_pen")
rclpy.spin_until_future_complete(node, pen.call_async(SetPen.Request()))
