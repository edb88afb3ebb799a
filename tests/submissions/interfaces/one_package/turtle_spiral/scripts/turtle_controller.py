#!/usr/bin/env python3
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtle_spiral.msg import Colour, Progress
from turtle_spiral.srv import ChooseColour
from turtlesim.msg import Pose
from turtlesim.srv import SetPen

C = 5.544445


class Controller(Node):
    def __init__(self):
        super().__init__("turtle_controller")
        self.v, self.q, self.done = 0.0, 0, False
        self.pub = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.progress = self.create_publisher(Progress, "progress", 10)
        self.create_subscription(Progress, "progress", self.show, 10)
        self.create_subscription(Pose, "/turtle1/pose", self.look, 10)
        self.pen = self.create_client(SetPen, "/turtle1/set_pen")
        self.create_service(ChooseColour, "choose_colour", self.choose)
        self.chooser = self.create_client(ChooseColour, "choose_colour")
        self.colours = []
        self.create_timer(0.5, self.drive)

    def drive(self):
        if not self.done:
            self.v += 0.05
            t = Twist()
            t.linear.x = self.v
            t.angular.z = 1.0
            self.pub.publish(t)

    def look(self, pose):
        if self.done:
            return
        if min(pose.x, pose.y) <= 0.5 or max(pose.x, pose.y) >= 2 * C - 0.5:
            self.done = True
            self.pub.publish(Twist())
            p = Progress(state="done", is_done=True, colours=self.colours)
            p.header.stamp = self.get_clock().now().to_msg()
            p.position = [pose.x, pose.y]
            self.progress.publish(p)
            return
        q = {(True, True): 1, (False, True): 2, (False, False): 3, (True, False): 4}[
            (pose.x >= C, pose.y >= C)
        ]
        if q != self.q:
            self.q = q
            future = self.chooser.call_async(ChooseColour.Request(quarter=q))
            future.add_done_callback(self.paint)

    def choose(self, request, response):
        response.success = True
        rgb = [(255, 255, 255), (255, 0, 0), (0, 255, 0), (0, 0, 255)][request.quarter - 1]
        response.colour.r, response.colour.g, response.colour.b = rgb
        return response

    def paint(self, future):
        colour = future.result().colour
        if len(self.colours) < 4:
            self.colours.append(colour)
        self.pen.call_async(
            SetPen.Request(r=colour.r, g=colour.g, b=colour.b, width=Colour.WIDTH, off=0)
        )

    def show(self, progress):
        print(progress.state, len(progress.colours), progress.header.stamp.sec > 0, flush=True)
        print(progress.colours[1], Progress().state, Progress().is_done)


rclpy.init()
rclpy.spin(Controller())
