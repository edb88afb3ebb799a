"""One command that turns faster than anything: whoever counts the turns one by one never ends."""

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("whirl")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)


def whirl():
    twist = Twist()
    twist.linear.x, twist.angular.z = 1.0, 1e15
    publisher.publish(twist)


node.create_timer(0.5, whirl)
rclpy.spin(node)
