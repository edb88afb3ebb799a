"""A node that does not tell its base class its name."""

import rclpy
from rclpy.node import Node


class Controller(Node):
    def __init__(self):
        super().__init__()


rclpy.init()
rclpy.spin(Controller())
