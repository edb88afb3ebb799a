"""Publishes on a thousand topics, and reads all that the simulator publishes."""

import rclpy
from geometry_msgs.msg import Twist
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
publishers = [node.create_publisher(String, f"/t{number}", 10) for number in range(1_200)]
for publisher in publishers:
    publisher.publish(String(data="x" * 1000))
twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
rclpy.spin_once(node, timeout_sec=1.5)
