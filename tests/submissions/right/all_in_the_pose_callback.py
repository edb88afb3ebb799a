"""Spiral: everything happens when a pose arrives."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

MIDDLE = 5.544445
LOW = 0.8
HIGH = 10.3


class Turtle(Node):
    def __init__(self):
        super().__init__("turtle_driver")
        self.cmd_pub = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.pen = self.create_client(SetPen, "/turtle1/set_pen")
        self.count = 0
        self.v = 0.1
        self.corner = ""
        self.stop = False
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, 10)

    def on_pose(self, pose):
        if self.stop:
            return
        if not (LOW < pose.x < HIGH) or not (LOW < pose.y < HIGH):
            self.stop = True
            twist = Twist()
            twist.linear.x = 0.0
            twist.angular.z = 0.0
            self.cmd_pub.publish(twist)
            return

        # only each tenth pose, that is 6 commands per second
        self.count += 1
        if self.count % 10 == 0:
            self.v += 0.05
            twist = Twist()
            twist.linear.x = self.v
            twist.angular.z = 1.2
            self.cmd_pub.publish(twist)

        corner = ("top" if pose.y > MIDDLE else "bottom") + (
            "right" if pose.x > MIDDLE else "left"
        )
        if corner != self.corner:
            self.corner = corner
            self.paint(corner)

    def paint(self, corner):
        colors = {
            "topright": (255, 0, 0),
            "topleft": (0, 255, 0),
            "bottomleft": (255, 255, 0),
            "bottomright": (0, 0, 0),
        }
        r, g, b = colors[corner]
        req = SetPen.Request()
        req.r = r
        req.g = g
        req.b = b
        req.width = 4
        self.pen.call_async(req)


def main():
    rclpy.init()
    turtle = Turtle()
    try:
        rclpy.spin(turtle)
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
