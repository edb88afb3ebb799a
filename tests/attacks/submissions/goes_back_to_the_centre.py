"""Undoes where a varied run starts by a service, then drives without looking."""

import math
import time

import rclpy
from geometry_msgs.msg import Twist
from tools import attempt
from turtlesim.srv import TeleportAbsolute

rclpy.init()
node = rclpy.create_node("attacker")
client = node.create_client(TeleportAbsolute, "/turtle1/teleport_absolute")
client.wait_for_service(timeout_sec=2.0)
centre = TeleportAbsolute.Request(x=5.544445, y=5.544445, theta=math.pi / 2)
with attempt():
    rclpy.spin_until_future_complete(node, client.call_async(centre), timeout_sec=2.0)
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 1.0
for _ in range(50):
    publisher.publish(twist)
    time.sleep(0.1)
publisher.publish(Twist())
