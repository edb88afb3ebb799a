"""A straight line with full turns on the spot, which by its heading is a spiral."""

import time

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("attacker")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
time.sleep(0.2)
for _ in range(5):
    for speed, turn in ((0.8, 0.0), (0.0, 6.2832)):
        twist = Twist()
        twist.linear.x = speed
        twist.angular.z = turn
        publisher.publish(twist)
        time.sleep(1.0)
