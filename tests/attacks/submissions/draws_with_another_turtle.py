"""A spiral with the pen up, and one more turtle: where it was is not what it has drawn."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen, Spawn

CENTRE = 5.544445
COLOURS = {(True, True): (255,) * 3, (False, True): (255, 0, 0), (False, False): (0, 255, 0)}


class Controller(Node):
    def __init__(self):
        super().__init__("attacker")
        self.speed, self.where, self.stopped = 0.0, None, False
        self.pen = self.create_client(SetPen, "/turtle1/set_pen")
        self.pen.wait_for_service()
        self.spawn = self.create_client(Spawn, "/spawn")
        self.spawn.call_async(Spawn.Request(x=5.5, y=5.5, theta=0.0, name="other"))
        self.velocity = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "/turtle1/pose", self.watch, 10)
        self.create_timer(0.5, self.drive)

    def drive(self):
        self.speed += 0.15
        twist = Twist()
        if not self.stopped:
            twist.linear.x, twist.angular.z = self.speed, 1.0
        self.velocity.publish(twist)

    def watch(self, pose):
        self.stopped |= not (0.5 < pose.x < 10.5 and 0.5 < pose.y < 10.5)
        where = pose.x >= CENTRE, pose.y >= CENTRE
        if where != self.where:
            self.where = where
            r, g, b = COLOURS.get(where, (0, 0, 255))
            self.pen.call_async(SetPen.Request(r=r, g=g, b=b, width=3, off=1))


rclpy.init()
rclpy.spin(Controller())
