"""Publishes in a loop that never waits."""

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 0.05
twist.angular.z = 1.0
while rclpy.ok():
    velocity.publish(twist)
