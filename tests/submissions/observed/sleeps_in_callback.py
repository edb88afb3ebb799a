"""Sleeps in the callback of the pose, by a function of its own and in two portions."""

import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose


def pause():
    time.sleep(0.15)


class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        self.velocity = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, 1)
        self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        self.velocity.publish(Twist())

    def on_pose(self, pose):
        time.sleep(0.05)
        pause()


rclpy.init()
node = Controller()
for _ in range(20):
    rclpy.spin_once(node, timeout_sec=1.0)
