"""A loop in a callback waits for what comes after the callback only."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen


class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        self.publisher = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.pen = self.create_client(SetPen, "/turtle1/set_pen")
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, 10)
        self.pose = None
        self.speed = 0.5

    def on_pose(self, pose):
        future = self.pen.call_async(SetPen.Request())
        while not future.done():
            pass

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
