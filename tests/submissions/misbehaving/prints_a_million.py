"""Prints a million lines, drives, and stops."""

import time

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
for thousand in range(1_000):
    print("\n".join(f"line {1_000 * thousand + number}" for number in range(1_000)))
time.sleep(10)
