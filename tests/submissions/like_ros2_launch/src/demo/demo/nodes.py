import sys

import rclpy
from rclpy.node import Node


class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.declare_parameter("rate", 1.0)
        self.get_logger().info(f"rate {self.get_parameter('rate').value}")


def main():
    rclpy.init()
    rclpy.spin(Talker())


def work():
    print("done", *sys.argv[1:])
