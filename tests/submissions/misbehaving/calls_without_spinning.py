"""client.call() where nobody spins."""

import rclpy
from turtlesim.srv import SetPen

rclpy.init()
node = rclpy.create_node("controller")
pen = node.create_client(SetPen, "/turtle1/set_pen")
pen.wait_for_service()
pen.call(SetPen.Request(r=255, width=3))
