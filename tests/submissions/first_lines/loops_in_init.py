"""A loop in __init__, before anything can spin."""

import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose


class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        self.publisher = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, 10)
        self.pose = None
        self.speed = 0.5
        while rclpy.ok():
            self.on_timer()
            time.sleep(0.1)

    def on_pose(self, pose):
        self.pose = pose

    def on_timer(self):
        if self.pose is None:
            return
        self.speed += 0.05
        twist = Twist()
        twist.linear.x = self.speed
        twist.angular.z = 1.0
        self.publisher.publish(twist)


def main():
    rclpy.init()
    rclpy.spin(Controller())


if __name__ == "__main__":
    main()
