"""One command of 10^15: turns that somebody may count one by one."""

import time

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("attacker")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 0.5
twist.angular.z = 1e15
time.sleep(0.2)
for _ in range(4):
    publisher.publish(twist)
    time.sleep(0.5)
