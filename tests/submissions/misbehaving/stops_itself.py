"""Drives, then stops its own process."""

import os
import signal
import time

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
time.sleep(0.5)
os.kill(os.getpid(), signal.SIGSTOP)
