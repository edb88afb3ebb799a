"""Asks a service of a turtle that is being killed, and waits for the answer that never comes."""

import rclpy
from geometry_msgs.msg import Twist
from turtlesim.srv import Kill, SetPen, Spawn

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
spawn = node.create_client(Spawn, "/spawn")
kill = node.create_client(Kill, "/kill")
pen = node.create_client(SetPen, "/turtle2/set_pen")
spawn.wait_for_service()
answer = spawn.call_async(Spawn.Request(x=1.0, y=1.0, theta=0.0, name="turtle2"))
rclpy.spin_until_future_complete(node, answer)
print(pen.service_is_ready())
gone = kill.call_async(Kill.Request(name="turtle2"))
first = pen.call_async(SetPen.Request(r=1))
rclpy.spin_until_future_complete(node, gone)
second = pen.call_async(SetPen.Request(r=2))
print(first.done(), second.done(), pen.service_is_ready(), flush=True)
rclpy.spin_until_future_complete(node, second, timeout_sec=1.0)
print(second.done(), flush=True)
twist.linear.x = -1.0
velocity.publish(twist)
rclpy.spin_until_future_complete(node, first)
print("never")
