"""Has the simulator follow a clock that stands still, so that one command drives for ever."""

import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rosgraph_msgs.msg import Clock

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
clock = node.create_publisher(Clock, "/clock", 10)
turtlesim = AsyncParameterClient(node, "turtlesim")
turtlesim.wait_for_services()
future = turtlesim.set_parameters([Parameter("use_sim_time", value=True)])
rclpy.spin_until_future_complete(node, future)
print(future.result().results[0].reason)
message = Clock()
message.clock.sec = 1
clock.publish(message)
twist = Twist()
twist.linear.x = 0.5
velocity.publish(twist)
time.sleep(8.0)
