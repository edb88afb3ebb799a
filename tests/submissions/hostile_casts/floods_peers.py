"""Calls a peer's services, and sends it goals, thousands of times."""

import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rclpy.action import ActionClient

rclpy.init()
node = rclpy.create_node("node")
clients = [node.create_client(AddTwoInts, name) for name in ("divide", "slow")]
fibonacci = ActionClient(node, Fibonacci, "fibonacci")
for each in clients:
    each.wait_for_service()


def ask():
    for _ in range(100):
        for each in clients:
            each.call_async(AddTwoInts.Request(a=6, b=0))
    for _ in range(20):
        fibonacci.send_goal_async(Fibonacci.Goal(order=5))


node.create_timer(0.1, ask)
rclpy.spin(node)
