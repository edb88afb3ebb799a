"""A state machine: WAITING for the first pose, DRIVING, STOPPED."""

from enum import Enum

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen


class State(Enum):
    WAITING = 0
    DRIVING = 1
    STOPPED = 2


class StateMachine(Node):
    def __init__(self):
        super().__init__("state_machine")
        self.state = State.WAITING
        self.pose = None
        self.area = None
        self.velocity = 0.0

        self.publisher = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "/turtle1/pose", self.pose_cb, 10)
        self.service = self.create_client(SetPen, "/turtle1/set_pen")
        self.create_timer(0.1, self.update)

    def pose_cb(self, pose):
        self.pose = pose
        if self.state == State.DRIVING:
            self.check_area()
            if self.at_border():
                self.state = State.STOPPED
                self.halt()

    def update(self):
        if self.state == State.WAITING:
            if self.pose is not None:
                self.get_logger().info("first pose, here we go")
                self.state = State.DRIVING
        elif self.state == State.DRIVING:
            self.velocity += 0.06
            self.move(self.velocity, 2.0)

    def move(self, linear, angular):
        msg = Twist()
        msg.linear.x = linear
        msg.angular.z = angular
        self.publisher.publish(msg)

    def halt(self):
        self.move(0.0, 0.0)

    def at_border(self):
        if self.pose.x < 1.0:
            return True
        if self.pose.x > 10.08:
            return True
        if self.pose.y < 1.0:
            return True
        if self.pose.y > 10.08:
            return True
        return False

    def check_area(self):
        area = (self.pose.x >= 5.54, self.pose.y >= 5.54)
        if area == self.area:
            return
        self.area = area
        if area == (True, True):
            self.set_color(255, 255, 255)
        elif area == (False, True):
            self.set_color(0, 0, 0)
        elif area == (False, False):
            self.set_color(255, 200, 0)
        else:
            self.set_color(200, 0, 0)

    def set_color(self, r, g, b):
        request = SetPen.Request()
        request.r = r
        request.g = g
        request.b = b
        request.width = 3
        request.off = 0
        self.service.call_async(request)


def main():
    rclpy.init()
    machine = StateMachine()
    rclpy.spin(machine)
    machine.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
