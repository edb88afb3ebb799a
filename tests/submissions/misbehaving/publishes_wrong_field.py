"""Puts a number where a vector belongs: only rclpy's C++ notices."""

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist(check_fields=False)  # as where ROS_PYTHON_CHECK_FIELDS is not set
twist.linear = 1.0
velocity.publish(twist)
