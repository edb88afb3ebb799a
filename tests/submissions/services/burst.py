"""Twenty commands at once: the simulator's reader keeps seven, and takes one a tick."""

import time

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
for number in range(1, 21):
    twist = Twist()
    twist.linear.x = float(number)
    velocity.publish(twist)
time.sleep(1.0)
