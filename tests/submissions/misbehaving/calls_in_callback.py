"""client.call() inside a callback of a single-threaded executor."""

import rclpy
from rclpy.node import Node
from turtlesim.srv import SetPen


class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        self.pen = self.create_client(SetPen, "/turtle1/set_pen")
        self.create_timer(1.0, self.on_timer)

    def on_timer(self):
        self.pen.call(SetPen.Request(r=255, width=3))


rclpy.init()
rclpy.spin(Controller())
