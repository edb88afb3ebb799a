"""What every attack is followed by: drives, and earns its points."""

import time

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
publisher = rclpy.create_node("honest").create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 2.0
for _ in range(20):
    publisher.publish(twist)
    time.sleep(0.05)
