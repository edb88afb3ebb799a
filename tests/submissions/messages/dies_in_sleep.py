"""Sleeps and dies, long after its last command; what it subscribes to it never hears."""

import os
import time

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


node.create_subscription(Pose, "/turtle1/pose", on_pose, 10)
drive(1.0, 0.1)
time.sleep(0.8333)
os._exit(5)
