"""Waits for a service that nobody has, in a loop; and before for one that somebody has."""

import rclpy
from rclpy.node import Node
from turtlesim.srv import SetPen


class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        self.there = self.create_client(SetPen, "/turtle1/set_pen")
        self.there.wait_for_service()
        self.pen = self.create_client(SetPen, "/set_pen")
        while not self.pen.wait_for_service(timeout_sec=1.0):
            self.get_logger().info("waiting")


rclpy.init()
rclpy.spin(Controller())
