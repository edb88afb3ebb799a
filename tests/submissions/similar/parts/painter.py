"""A right solution in two files: this one draws, geometry.py knows where."""

import rclpy
from geometry import Spot
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

COLOURS = {
    "upper right": [250, 250, 250],
    "upper left": [250, 0, 0],
    "lower left": [0, 250, 0],
    "lower right": [0, 0, 250],
}


def speeds(first=0.06, step=0.06):
    value = first
    while True:
        yield value
        value += step


class Painter(Node):
    def __init__(self, name="painter"):
        super().__init__(name)
        self.parts = []
        self.speed = speeds()
        self.move = self.create_publisher(Twist, "turtle1/cmd_vel", 5)
        self.colour = self.create_client(SetPen, "turtle1/set_pen")
        self.create_subscription(Pose, "turtle1/pose", lambda p: self.at(Spot(p.x, p.y)), 5)
        self.ticking = self.create_timer(0.5, self.go)

    def go(self):
        order = Twist()
        order.linear.x = next(self.speed)
        order.angular.z = 0.9
        self.move.publish(order)

    def at(self, spot):
        if self.ticking.is_canceled():
            return
        if spot.margin < 0.8:
            self.ticking.cancel()
            self.move.publish(Twist())
        elif not self.parts or self.parts[-1] != spot.part:
            self.parts.append(spot.part)
            ask = SetPen.Request()
            ask.r, ask.g, ask.b = COLOURS[spot.part]
            ask.width = 3
            self.colour.call_async(ask)


def main():
    rclpy.init()
    rclpy.spin(Painter())


if __name__ == "__main__":
    main()
