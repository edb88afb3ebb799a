"""A stand-in for a mistake of the grader's own: takes away what its code relies on.

In real time there is nothing to take away, and the turtle drives.
"""

import contextlib

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
with contextlib.suppress(AttributeError):
    velocity.handle.writer.remote = None
# a program that catches everything must not hide it
with contextlib.suppress(Exception):
    velocity.publish(twist)
with contextlib.suppress(KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
    rclpy.spin(node)
