"""Has everything but never spins."""

import threading

import rclpy
from turtlesim.msg import Pose

rclpy.init()
node = rclpy.create_node("controller")
node.create_subscription(Pose, "/turtle1/pose", print, 10)
threading.Event().wait()
