"""One thread that sleeps in the callback; a command a second, clockwise."""
from math import tau
from time import sleep

import rclpy
from rclpy.node import Node
from geometry_msgs.msg import Twist
from turtle_exercise_interfaces.srv import DrawPolygon


class Drawer(Node):
    def __init__(self):
        super().__init__("drawer")
        self.pub = self.create_publisher(Twist, "turtle1/cmd_vel", 1)
        self.create_service(DrawPolygon, "draw_polygon", self.draw)

    def go(self, x=0.0, z=0.0):
        cmd = Twist()
        cmd.linear.x = x
        cmd.angular.z = z
        self.pub.publish(cmd)  # the turtle drives on for a second, and stops by itself
        sleep(1.1)

    def draw(self, request, response):
        if request.sides <= 2:
            response.message = "too few sides: %d" % request.sides
            return response
        for i in range(request.sides):
            self.go(x=request.length)
            self.go(z=-tau / request.sides)
        response.success = True
        return response


rclpy.init()
rclpy.spin(Drawer())
