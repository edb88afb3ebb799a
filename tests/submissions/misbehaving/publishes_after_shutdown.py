"""Stops ROS first, the turtle then."""

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
rclpy.shutdown()
velocity.publish(Twist())
