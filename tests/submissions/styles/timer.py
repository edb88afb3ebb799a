"""A timer and a subscription under rclpy.spin: what the course teaches."""

import rclpy
from rclpy.node import Node
from spiral import CMD_VEL, PERIOD_S, POSE, SET_PEN, Pose, SetPen, Spiral, Twist


class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        self.spiral = Spiral()
        self.velocity = self.create_publisher(Twist, CMD_VEL, 10)
        self.pen = self.create_client(SetPen, SET_PEN)
        self.create_subscription(Pose, POSE, self.on_pose, 10)
        self.create_timer(PERIOD_S, self.on_timer)

    def on_timer(self):
        if not self.spiral.done:
            self.velocity.publish(self.spiral.command())

    def on_pose(self, pose):
        if self.spiral.done:
            return
        if self.spiral.is_outside(pose):
            self.velocity.publish(Twist())
        elif request := self.spiral.pen(pose):
            self.pen.call_async(request)


def main():
    rclpy.init()
    rclpy.spin(Controller())


if __name__ == "__main__":
    main()
