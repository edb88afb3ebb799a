"""Spins once, and is through."""

import rclpy
from turtlesim.msg import Pose

rclpy.init()
node = rclpy.create_node("controller")
node.create_subscription(Pose, "/turtle1/pose", lambda pose: None, 10)
rclpy.spin_once(node)
