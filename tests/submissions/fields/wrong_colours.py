"""Tries colours and widths that are none, and tells what it hears; then drives with an int."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.srv import SetPen

WRONG = {"r": 256, "g": -1, "b": 255.0, "width": 3.0, "off": None}


class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        self.velocity = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.create_timer(0.1, self.drive)

    def drive(self):
        twist = Twist()
        twist.linear.x = 2
        self.velocity.publish(twist)


for field, value in WRONG.items():
    try:
        SetPen.Request(**{field: value})
    except AssertionError as error:
        print(error)
rclpy.init()
rclpy.spin(Controller())
