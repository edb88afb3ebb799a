"""Draws the spiral; `turn` and `margin` are parameters, which the launch file sets."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

SIZE = 11.09
HALF = SIZE / 2


class Painter(Node):
    def __init__(self):
        super().__init__("painter")
        self.declare_parameter("turn", 1.0)
        self.declare_parameter("margin", 1.0)
        self.turn = self.get_parameter("turn").value
        self.margin = self.get_parameter("margin").value
        self.speed = 0.0
        self.quarter = None
        self.active = True
        self.commands = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.pen = self.create_client(SetPen, "/turtle1/set_pen")
        self.create_subscription(Pose, "/turtle1/pose", self.check, 10)
        self.create_timer(0.3, self.drive)

    def drive(self):
        if self.active:
            self.speed += 0.08
            command = Twist()
            command.linear.x = self.speed
            command.angular.z = self.turn
            self.commands.publish(command)

    def check(self, pose):
        if not self.active:
            return
        walls = [pose.x, SIZE - pose.x, pose.y, SIZE - pose.y]
        if min(walls) < self.margin:
            self.active = False
            self.commands.publish(Twist())
            self.get_logger().info(f"{min(walls):.2f} m from a wall")
        else:
            self.choose_color(pose)

    def choose_color(self, pose):
        quarter = 2 * int(pose.y > HALF) + int(pose.x > HALF)
        if quarter == self.quarter:
            return
        self.quarter = quarter
        request = SetPen.Request()
        request.width = 4
        request.off = 0
        if quarter == 0:
            request.r, request.g, request.b = 0, 0, 0
        elif quarter == 1:
            request.r, request.g, request.b = 255, 255, 0
        elif quarter == 2:
            request.r, request.g, request.b = 255, 0, 0
        else:
            request.r, request.g, request.b = 255, 255, 255
        self.pen.call_async(request)


def main(args=None):
    rclpy.init(args=args)
    node = Painter()
    rclpy.spin(node)


if __name__ == "__main__":
    main()
