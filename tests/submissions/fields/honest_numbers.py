"""Numbers that are right though they are no plain ones: of numpy, and of classes of its own."""

import math

import numpy
import rclpy
from geometry_msgs.msg import Twist
from turtlesim.srv import SetPen


class Speed(float):
    pass


twist = Twist()
twist.linear.x = numpy.float64(1.0)
twist.linear.x = numpy.hypot(0.6, 0.8)
twist.linear.y = Speed(0.0)
twist.angular.z = math.nan
twist.angular.z = 0.5
SetPen.Request(r=True, g=255, width=3)
rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
velocity.publish(twist)
rclpy.spin_once(node, timeout_sec=0.5)
