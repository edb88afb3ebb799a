"""Needs another program: that lives in real time."""

import subprocess
import time

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
subprocess.run(["sleep", "0.5"], check=True)
twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
time.sleep(1)
