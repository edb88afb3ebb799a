"""A right solution that takes ten seconds: it turns and grows faster than the reference."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

C = 5.544445
COLORS = {
    (True, True): (255, 255, 0),
    (False, True): (200, 0, 200),
    (False, False): (0, 200, 200),
    (True, False): (0, 0, 0),
}


class Quick(Node):
    def __init__(self):
        super().__init__("quick")
        self.speed, self.where, self.done = 0.0, None, False
        self.pub = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.pen = self.create_client(SetPen, "/turtle1/set_pen")
        self.pen.wait_for_service()
        self.create_subscription(Pose, "/turtle1/pose", self.on_pose, 10)
        self.create_timer(0.1, self.on_timer)

    def on_timer(self):
        if not self.done:
            self.speed += 0.15
            twist = Twist()
            twist.linear.x, twist.angular.z = self.speed, 3.0
            self.pub.publish(twist)

    def on_pose(self, pose):
        if self.done:
            return
        if min(pose.x, pose.y, 11.09 - pose.x, 11.09 - pose.y) < 0.9:
            self.done = True
            self.pub.publish(Twist())
            return
        where = (pose.x > C, pose.y > C)
        if where != self.where:
            self.where = where
            r, g, b = COLORS[where]
            self.pen.call_async(SetPen.Request(r=r, g=g, b=b, width=4, off=0))


def main():
    rclpy.init()
    rclpy.spin(Quick())


if __name__ == "__main__":
    main()
