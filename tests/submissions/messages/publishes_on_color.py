"""A command for each colour."""

import rclpy
from geometry_msgs.msg import Twist
from turtlesim.msg import Color, Pose

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


def on_color(color):
    global n
    n += 1
    if n < 120:
        drive(1.0, color.b / 255 + n / 100)


n = 0
node.create_subscription(Color, "/turtle1/color_sensor", on_color, 10)


node.create_subscription(Pose, "/turtle1/pose", on_pose, 10)
rclpy.spin(node)
