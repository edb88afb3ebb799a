"""A timer that wants to publish a hundred thousand commands a second."""

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 0.05
twist.angular.z = 1.0
node.create_timer(1e-5, lambda: velocity.publish(twist))
rclpy.spin(node)
