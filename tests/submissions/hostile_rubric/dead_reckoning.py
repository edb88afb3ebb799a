"""Brings the turtle back to the centre, then counts: where it is it never asks."""

import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from std_srvs.srv import Empty
from turtlesim.srv import Kill, SetPen, Spawn, TeleportAbsolute

WAY = "reset"  # or teleport, respawn
CENTRE = 5.544445
COLORS = {1: (255, 255, 255), 2: (255, 0, 0), 3: (0, 255, 0), 4: (0, 0, 255)}


class Counter(Node):
    def __init__(self):
        super().__init__("counter")
        self.velocity = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.back_to_the_centre()
        self.pen = self.create_client(SetPen, "/turtle1/set_pen")
        self.pen.wait_for_service()
        self.x = self.y = CENTRE
        self.theta = self.speed = 0.0
        self.quadrant = 0
        self.stopped = False
        self.create_timer(0.5, self.drive)
        self.create_timer(0.016, self.count)

    def ask(self, kind, service, **values):
        client = self.create_client(kind, service)
        client.wait_for_service()
        rclpy.spin_until_future_complete(self, client.call_async(kind.Request(**values)))

    def back_to_the_centre(self):
        if WAY == "reset":
            self.ask(Empty, "/reset")
        elif WAY == "teleport":
            place = {"x": CENTRE, "y": CENTRE, "theta": 0.0}
            self.ask(TeleportAbsolute, "/turtle1/teleport_absolute", **place)
        elif WAY == "respawn":
            self.ask(Kill, "/kill", name="turtle1")
            self.ask(Spawn, "/spawn", x=CENTRE, y=CENTRE, theta=0.0, name="turtle1")

    def drive(self):
        if not self.stopped:
            self.speed += 0.05
            twist = Twist()
            twist.linear.x, twist.angular.z = self.speed, 1.0
            self.velocity.publish(twist)

    def count(self):
        if self.stopped or not self.speed:
            return
        self.theta += 0.016
        self.x += 0.016 * self.speed * math.cos(self.theta)
        self.y += 0.016 * self.speed * math.sin(self.theta)
        if max(abs(self.x - CENTRE), abs(self.y - CENTRE)) > CENTRE - 0.9:
            self.stopped = True
            self.velocity.publish(Twist())
            return
        upper, right = self.y >= CENTRE, self.x >= CENTRE
        quadrant = (1 if right else 2) if upper else (4 if right else 3)
        if quadrant != self.quadrant:
            self.quadrant = quadrant
            r, g, b = COLORS[quadrant]
            self.pen.call_async(SetPen.Request(r=r, g=g, b=b, width=3, off=0))


rclpy.init()
rclpy.spin(Counter())
