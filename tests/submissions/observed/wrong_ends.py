"""Publishes another type, reads a topic that nobody publishes, and forgets to spin."""

import time

import rclpy
from geometry_msgs.msg import TwistStamped
from rclpy.action import ActionClient
from rclpy.node import Node
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Pose
from turtlesim.srv import SetPen


class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        self.velocity = self.create_publisher(TwistStamped, "/turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "/pose", print, 10)
        self.create_subscription(Pose, "turtle1/pose", print, 10)
        self.pen = self.create_client(SetPen, "/set_pen")
        self.rotation = ActionClient(self, RotateAbsolute, "/turtle1/rotate_absolute")


def main():
    rclpy.init()
    node = Controller()
    for _ in range(6):
        node.velocity.publish(TwistStamped())
        time.sleep(0.5)


main()
