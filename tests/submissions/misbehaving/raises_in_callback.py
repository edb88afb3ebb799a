"""A callback with a mistake."""

import rclpy
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)


def on_pose(pose):
    twist = Twist()
    twist.linear.x = 1.0
    velocity.publish(twist)
    if pose.x > 6.0:
        print(pose.z)


node.create_subscription(Pose, "/turtle1/pose", on_pose, 10)
rclpy.spin(node)
