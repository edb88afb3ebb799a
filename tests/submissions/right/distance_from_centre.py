"""Stops by the distance from the centre of the window."""

from math import sqrt

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

CX = CY = 5.544


class Snail(Node):
    def __init__(self):
        super().__init__("snail")
        # what we know
        self.speed = 0.1
        self.dist = 0.0
        self.color = 0
        self.at_edge = False
        # what we use
        self.pub_vel = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.sub_pose = self.create_subscription(Pose, "/turtle1/pose", self.pose_received, 10)
        self.cli_pen = self.create_client(SetPen, "/turtle1/set_pen")
        self.tmr = self.create_timer(0.2, self.send_velocity)

    def send_velocity(self):
        if self.at_edge is False:
            vel = Twist()
            vel.linear.x = self.speed
            vel.angular.z = -1.2
            self.pub_vel.publish(vel)
            self.speed = self.speed + 0.06

    def pose_received(self, msg):
        dx = msg.x - CX
        dy = msg.y - CY
        self.dist = sqrt(dx**2 + dy**2)
        if self.dist > 5.0 and not self.at_edge:
            self.at_edge = True
            self.pub_vel.publish(Twist())
            self.get_logger().info("stopped at distance " + str(self.dist))
        if self.at_edge:
            return
        if dx > 0 and dy > 0:
            self.use_color(1, 255, 50, 50)
        elif dx <= 0 and dy > 0:
            self.use_color(2, 50, 255, 50)
        elif dx <= 0 and dy <= 0:
            self.use_color(3, 255, 255, 255)
        else:
            self.use_color(4, 10, 10, 10)

    def use_color(self, number, r, g, b):
        if number == self.color:
            return
        self.color = number
        pen = SetPen.Request()
        pen.r = r
        pen.g = g
        pen.b = b
        pen.width = 5
        pen.off = 0
        self.cli_pen.call_async(pen)


def main():
    rclpy.init()
    snail = Snail()
    rclpy.spin(snail)
    snail.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
