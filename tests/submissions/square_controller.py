"""A right solution of the square: it goes from corner to corner by the pose that it is told."""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose

SIDE = 2.0


class Square(Node):
    def __init__(self):
        super().__init__("square")
        self.corners = None
        self.turning = True
        self.publisher = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, 10)

    def on_pose(self, pose):
        if self.corners is None:
            self.corners = corners_from(pose)
        if not self.corners:
            return
        x, y = self.corners[0]
        way = math.hypot(x - pose.x, y - pose.y)
        error = math.remainder(math.atan2(y - pose.y, x - pose.x) - pose.theta, math.tau)
        twist = Twist()
        if way < 0.01:  # the next one; for the moment, or after the last one for good, stand still
            self.corners.pop(0)
            self.turning = True
        elif self.turning:
            twist.angular.z = 4.0 * error
            self.turning = abs(error) > 0.005
        else:
            twist.linear.x = min(1.5, 4.0 * way)
            twist.angular.z = 2.0 * error if way > 0.2 else 0.0
        self.publisher.publish(twist)


def corners_from(pose):
    """The other three corners and the start again, anticlockwise."""
    x, y = pose.x, pose.y
    corners = []
    for side in range(4):
        heading = pose.theta + side * math.pi / 2
        x, y = x + SIDE * math.cos(heading), y + SIDE * math.sin(heading)
        corners.append((x, y))
    return corners


def main():
    rclpy.init()
    rclpy.spin(Square())


if __name__ == "__main__":
    main()
