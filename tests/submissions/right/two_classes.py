"""The brush is a class of its own, which the node uses."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen


class Brush:
    PALETTE = [(255, 0, 0), (255, 255, 255), (0, 0, 0), (0, 220, 0)]

    def __init__(self, node):
        self.client = node.create_client(SetPen, "/turtle1/set_pen")
        self.last = -1

    def paint(self, x, y):
        index = 0
        if x < 5.54:
            index += 1
        if y < 5.54:
            index += 2
        if index != self.last:
            self.last = index
            self.send(self.PALETTE[index])

    def send(self, color):
        req = SetPen.Request()
        req.r, req.g, req.b = color
        req.width = 3
        req.off = 0
        self.client.call_async(req)


class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.brush = Brush(self)
        self.radius = 0.0
        self.running = True
        self.pub = self.create_publisher(Twist, "/turtle1/cmd_vel", 1)
        self.create_subscription(Pose, "/turtle1/pose", self.got_pose, 1)
        self.create_timer(0.2, self.tick)

    def tick(self):
        if self.running:
            self.radius += 0.04
            self.send(1.5 * self.radius, 1.5)

    def send(self, v, w):
        twist = Twist()
        twist.linear.x = v
        twist.angular.z = w
        self.pub.publish(twist)

    def got_pose(self, pose):
        if self.running:
            if 0.9 < pose.x < 10.2 and 0.9 < pose.y < 10.2:
                self.brush.paint(pose.x, pose.y)
            else:
                self.running = False
                self.send(0.0, 0.0)


def main(args=None):
    rclpy.init(args=args)
    driver = Driver()
    rclpy.spin(driver)


if __name__ == "__main__":
    main()
