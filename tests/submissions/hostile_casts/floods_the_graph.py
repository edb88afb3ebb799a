"""Makes topics, nodes and parameters, and sets these, without end."""

import rclpy
from rcl_interfaces.msg import ParameterEvent
from std_msgs.msg import String

rclpy.init()
nodes = [rclpy.create_node(f"node{number}") for number in range(30)]
events = nodes[0].create_publisher(ParameterEvent, "/parameter_events", 10)
made = []


def make():
    for _ in range(10):
        name = f"{'x' * 150}{len(made)}"
        made.append(nodes[0].create_publisher(String, name, 10))
        nodes[1].declare_parameter(name, "x" * 10_000)
        events.publish(ParameterEvent(node="/peer"))


nodes[0].create_timer(0.1, make)
rclpy.spin(nodes[0])
