"""Asks the simulator for what it may not survive: a parameter without a type, a nameless home."""

import rclpy
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from std_srvs.srv import Empty
from tools import attempt
from turtlesim.srv import Spawn

rclpy.init()
node = rclpy.create_node("attacker")


def call(kind, name, request):
    client = node.create_client(kind, name)
    if client.wait_for_service(timeout_sec=1.0):
        rclpy.spin_until_future_complete(node, client.call_async(request), timeout_sec=1.0)


for name, value in (
    ("background_r", ParameterValue(type=10)),
    ("background_r", ParameterValue(type=255, integer_value=2**62)),
    ("canvas_folder", ParameterValue(type=4, string_value="~nosuchuser/x")),
    ("canvas_folder", ParameterValue(type=4, string_value="/proc/self/mem\x01")),
    ("no such parameter", ParameterValue(type=3, double_value=float("nan"))),
):
    with attempt():
        request = SetParameters.Request(parameters=[Parameter(name=name, value=value)])
        call(SetParameters, "/turtlesim/set_parameters", request)
    with attempt():
        call(Empty, "/turtlesim/save_canvas", Empty.Request())
with attempt():
    call(GetParameters, "/turtlesim/get_parameters", GetParameters.Request(names=["x" * 100_000]))
with attempt():
    call(Spawn, "/spawn", Spawn.Request(x=float("nan"), y=1e300, theta=float("inf"), name="a b/"))
