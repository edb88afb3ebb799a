"""Spawns, kills and sets what has a name of megabytes, again and again."""

import rclpy
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from turtlesim.srv import Kill, Spawn

rclpy.init()
node = rclpy.create_node("controller")
spawn = node.create_client(Spawn, "/spawn")
kill = node.create_client(Kill, "/kill")
setter = node.create_client(SetParameters, "/turtlesim/set_parameters")
getter = node.create_client(GetParameters, "/turtlesim/get_parameters")
for client in (spawn, kill, setter, getter):
    client.wait_for_service()

# ask without waiting: what is too long for the simulator is never answered
for length in (300, 1_000_000, 1_900_000, 5_000_000):
    name = "n" * length
    for _ in range(4):
        spawn.call_async(Spawn.Request(x=5.0, y=5.0, name=name))
        kill.call_async(Kill.Request(name=name))
        value = ParameterValue(type=4, string_value=name)
        setter.call_async(SetParameters.Request(parameters=[Parameter(name=name, value=value)]))
        if length < 2_000_000:
            rclpy.spin_once(node, timeout_sec=0.02)
many = [Parameter(name="background_r", value=ParameterValue(type=2, integer_value=7))] * 20_000
setter.call_async(SetParameters.Request(parameters=many))
getter.call_async(GetParameters.Request(names=["holonomic"] * 50_000))
while rclpy.ok():
    rclpy.spin_once(node, timeout_sec=1.0)
