"""Ends the process right after a command."""

import os

import rclpy
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
count = 0


def drive(linear, angular=0.0):
    twist = Twist()
    twist.linear.x, twist.angular.z = linear, angular
    velocity.publish(twist)


def on_pose(pose):
    global count
    count += 1
    if count == 10:
        drive(1.0, 0.5)
    if count == 47:
        drive(2.0, -1.0)
        drive(2.0, -1.5)
        os._exit(3)


node.create_subscription(Pose, "/turtle1/pose", on_pose, 10)
rclpy.spin(node)
