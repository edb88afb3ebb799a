"""The quadrant comes from the angle around the centre (atan2)."""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

CENTER_X = 5.544445
CENTER_Y = 5.544445
OMEGA = 1.0  # rad/s
GROWTH = 0.02  # m/s for each command


class AngleSpiral(Node):
    def __init__(self):
        super().__init__("angle_spiral")
        self.pub = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.cli = self.create_client(SetPen, "/turtle1/set_pen")
        self.n = 0
        self.sector = None
        self.is_done = False
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, 10)
        self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        """Send the next velocity."""
        if self.is_done:
            return
        self.n += 1
        t = Twist()
        t.linear.x = GROWTH * self.n
        t.angular.z = OMEGA
        self.pub.publish(t)

    def on_pose(self, p):
        """Look where the turtle is."""
        if self.is_done:
            return
        if max(abs(p.x - CENTER_X), abs(p.y - CENTER_Y)) > 4.6:
            self.is_done = True
            self.pub.publish(Twist())
            return
        angle = math.atan2(p.y - CENTER_Y, p.x - CENTER_X)
        if angle < 0.0:
            angle += 2 * math.pi
        sector = int(angle / (math.pi / 2)) % 4
        if sector != self.sector:
            self.sector = sector
            self.color(sector)

    def color(self, sector):
        rgb = [(255, 255, 255), (255, 0, 0), (0, 0, 0), (0, 230, 0)][sector]
        self.cli.call_async(SetPen.Request(r=rgb[0], g=rgb[1], b=rgb[2], width=3, off=0))


def main():
    rclpy.init()
    rclpy.spin(AngleSpiral())


if __name__ == "__main__":
    main()
