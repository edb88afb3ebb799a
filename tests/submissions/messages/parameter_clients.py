"""Asks for parameters in every way, and sets some."""

import rclpy
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import Parameter as Message
from rcl_interfaces.msg import ParameterEvent, ParameterValue
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    GetParameterTypes,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.parameter_event_handler import ParameterEventHandler

rclpy.init()
node = rclpy.create_node("controller")
other = rclpy.create_node("other")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
events = []


def now():
    return f"{node.get_clock().now().nanoseconds / 1e9 % 1000:.4f}"


def hear(event):
    events.append(event)
    print(now(), "event", event, flush=True)


node.create_subscription(ParameterEvent, "/parameter_events", hear, 10)
twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)


def call(kind, service, **fields):
    client = node.create_client(kind, service)
    print(now(), client.wait_for_service(timeout_sec=1.0))
    answer = client.call_async(kind.Request(**fields))
    rclpy.spin_until_future_complete(node, answer, timeout_sec=1.0)
    print(now(), service, answer.result(), flush=True)
    node.destroy_client(client)


blue = ParameterValue(type=2, integer_value=7)
call(ListParameters, "/turtlesim/list_parameters")
call(GetParameters, "/turtlesim/get_parameters", names=["background_r", "nothing", "use_sim_time"])
call(DescribeParameters, "/turtlesim/describe_parameters", names=["background_r", "holonomic"])
call(GetParameterTypes, "/turtlesim/get_parameter_types", names=["background_r", "nothing"])
call(
    SetParameters,
    "/turtlesim/set_parameters",
    parameters=[
        Message(name="background_b", value=blue),
        Message(name="nothing", value=blue),
        Message(name="background_r", value=ParameterValue(type=4, string_value="red")),
    ],
)
call(
    SetParametersAtomically,
    "/turtlesim/set_parameters_atomically",
    parameters=[Message(name="background_g", value=blue), Message(name="background_r", value=blue)],
)
client = AsyncParameterClient(node, "turtlesim")
print(client.wait_for_services(timeout_sec=1.0))
for future in (
    client.get_parameters(["background_r", "background_g"]),
    client.list_parameters(),
    client.set_parameters([Parameter("background_g", value=200)]),
    client.describe_parameters(["background_g"]),
):
    rclpy.spin_until_future_complete(node, future, timeout_sec=1.0)
    print(now(), future.result(), flush=True)
velocity.publish(twist)
node.declare_parameter("speed", 1.5)
node.set_parameters([Parameter("speed", value=2.5)])
handler = ParameterEventHandler(other)
handler.add_parameter_callback("speed", "controller", lambda p: print(now(), "told", p))
node.set_parameters([Parameter("speed", value=3.5)])
rclpy.spin_once(other, timeout_sec=0.1)
rclpy.spin_once(other, timeout_sec=0.1)
end = node.get_clock().now().nanoseconds + 10**9
while node.get_clock().now().nanoseconds < end:
    rclpy.spin_once(node, timeout_sec=0.1)
print(now(), len(events))
