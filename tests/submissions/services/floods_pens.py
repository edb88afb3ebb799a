"""Asks for twenty pens every 10 ms, while it drives, for five seconds."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.srv import SetPen


class Controller(Node):
    def __init__(self):
        super().__init__("controller")
        self.velocity = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.pen = self.create_client(SetPen, "/turtle1/set_pen")
        self.create_timer(0.01, self.on_timer)
        self.count = 0

    def on_timer(self):
        self.count += 1
        for shade in range(20):
            self.pen.call_async(SetPen.Request(r=shade, g=self.count % 256, b=0, width=3))
        if self.count % 10 == 0:
            twist = Twist()
            twist.linear.x, twist.angular.z = self.count / 400, 1.0
            self.velocity.publish(twist)
        if self.count == 500:
            raise SystemExit


rclpy.init()
rclpy.spin(Controller())
