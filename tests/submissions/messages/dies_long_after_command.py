"""Dies between two ticks, long after a command and right after another."""

import os
import signal

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


def end():
    drive(0.5)
    os.kill(os.getpid(), signal.SIGKILL)


node.create_timer(0.7773, end)
node.create_subscription(Pose, "/turtle1/pose", on_pose, 10)
rclpy.spin(node)
