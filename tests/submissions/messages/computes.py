"""Computes for a third of a second in some pose callbacks; no virtual time passes meanwhile."""

import rclpy
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
count = 0


def drive(linear, angular):
    twist = Twist()
    twist.linear.x, twist.angular.z = linear, angular
    velocity.publish(twist)


def on_pose(pose):
    global count
    count += 1
    if count == 10:
        drive(1.0, 0.5)
    if count in (12, 30, 31):
        sum(range(12_000_000))
    if count == 31:
        drive(1.0, -0.5)
    if count == 50:
        print(pose, node.get_clock().now().nanoseconds)


node.create_subscription(Pose, "/turtle1/pose", on_pose, 10)
rclpy.spin(node)
