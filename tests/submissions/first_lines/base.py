"""It drives a spiral, and never stops."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose


class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        self.publisher = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, 10)
        self.create_timer(0.5, self.on_timer)
        self.pose = None
        self.speed = 0.5

    def on_pose(self, pose):
        self.pose = pose

    def on_timer(self):
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
