"""Asks for one pose after the other and never spins, which wait_for_message does not need."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.wait_for_message import wait_for_message
from turtlesim.msg import Pose

rclpy.init()
node = rclpy.create_node("controller")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
for _ in range(3):
    is_there, pose = wait_for_message(Pose, node, "/turtle1/pose", time_to_wait=1.0)
    twist = Twist()
    twist.linear.x = 0.1 * pose.x
    publisher.publish(twist)
