"""Waits for an answer inside a callback of the executor that would bring it."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen


class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        self.velocity = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.pen = self.create_client(SetPen, "/turtle1/set_pen")
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, 10)

    def on_pose(self, pose):
        twist = Twist()
        twist.linear.x = 1.0
        self.velocity.publish(twist)
        if pose.x > 6.0:
            self.change_pen()

    def change_pen(self):
        answer = self.pen.call_async(SetPen.Request(r=255, width=3))
        rclpy.spin_until_future_complete(self, answer)


def main():
    rclpy.init()
    rclpy.spin(Controller())


if __name__ == "__main__":
    main()
