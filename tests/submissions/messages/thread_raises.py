"""A thread that spins dies of an exception; the main thread drives on."""

import threading
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
    if count == 30:
        drive(1.0, 0.5)
        raise ValueError(pose.x)


node.create_subscription(Pose, "/turtle1/pose", on_pose, 10)
spinner = threading.Thread(target=rclpy.spin, args=(node,))
spinner.start()
drive(0.7)
time.sleep(1.0)
print(count, spinner.is_alive())
drive(1.0)
time.sleep(0.2)
