"""Pen up, and one more turtle: what is seen and what was drawn are different things."""

import time

import rclpy
from geometry_msgs.msg import Twist
from turtlesim.srv import SetPen, Spawn

rclpy.init()
node = rclpy.create_node("attacker")
pen = node.create_client(SetPen, "/turtle1/set_pen")
spawn = node.create_client(Spawn, "/spawn")
pen.wait_for_service(timeout_sec=1.0)
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
spawn.call_async(Spawn.Request(x=5.5, y=5.5, theta=0.0, name="other"))
for r, g, b in ((255, 255, 255), (255, 0, 0), (0, 255, 0), (0, 0, 255)):
    pen.call_async(SetPen.Request(r=r, g=g, b=b, width=3, off=1))
    twist = Twist()
    twist.linear.x = 1.5
    twist.angular.z = 1.5708
    publisher.publish(twist)
    time.sleep(1.0)
