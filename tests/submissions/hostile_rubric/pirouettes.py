"""Drives straight ahead, and turns round on the spot now and then: turns, but no spiral."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose


class Dancer(Node):
    def __init__(self):
        super().__init__("dancer")
        self.velocity = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.stopped = False
        self.create_subscription(Pose, "/turtle1/pose", self.watch, 10)
        self.create_timer(0.5, self.drive)
        self.count = 0

    def drive(self):
        if self.stopped:
            return
        twist = Twist()
        if self.count % 14 == 0:
            twist.linear.x = 1.0
        else:
            twist.angular.z = 1.0
        self.count += 1
        self.velocity.publish(twist)

    def watch(self, pose):
        if not self.stopped and pose.x > 10.5:
            self.stopped = True
            self.velocity.publish(Twist())


rclpy.init()
rclpy.spin(Dancer())
