"""A loop with a rate; rclpy.spin runs in a thread beside it."""

import threading

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen


class Spiral(Node):
    def __init__(self):
        super().__init__("spiral_with_rate")
        self.pose = None
        self.pen_of = 0
        self.pub = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.sub = self.create_subscription(Pose, "/turtle1/pose", self.save_pose, 10)
        self.client = self.create_client(SetPen, "/turtle1/set_pen")

    def save_pose(self, pose):
        self.pose = pose
        self.update_pen(pose)

    def update_pen(self, pose):
        if pose.y >= 5.54:
            q = 1 if pose.x >= 5.54 else 2
        else:
            q = 3 if pose.x < 5.54 else 4
        if q == self.pen_of:
            return
        self.pen_of = q
        request = SetPen.Request()
        request.r, request.g, request.b = [(255, 0, 0), (0, 200, 0), (255, 255, 0), (255, 255, 255)][
            q - 1
        ]
        request.width = 3
        self.client.call_async(request)

    def near_wall(self):
        x, y = self.pose.x, self.pose.y
        return x < 1.4 or x > 9.7 or y < 1.4 or y > 9.7

    def drive(self, speed, turn):
        command = Twist()
        command.linear.x = speed
        command.angular.z = turn
        self.pub.publish(command)


def main():
    rclpy.init()
    spiral = Spiral()
    thread = threading.Thread(target=rclpy.spin, args=(spiral,), daemon=True)
    thread.start()
    rate = spiral.create_rate(10)
    speed = 0.0
    while rclpy.ok():
        if spiral.pose is None:
            rate.sleep()
            continue
        if spiral.near_wall():
            break
        speed += 0.03
        spiral.drive(speed, 1.3)
        rate.sleep()
    spiral.drive(0.0, 0.0)
    thread.join()


if __name__ == "__main__":
    main()
