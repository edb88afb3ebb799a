"""Asks itself for a parameter through the graph, for each command."""

import rclpy
from rcl_interfaces.srv import GetParameters
from rclpy.duration import Duration
from spiral import CMD_VEL, Spiral, Twist

rclpy.init()
node = rclpy.create_node("controller")
node.declare_parameter("growth", 0.1)
velocity = node.create_publisher(Twist, CMD_VEL, 10)
ask = node.create_client(GetParameters, "/controller/get_parameters")
assert ask.wait_for_service(timeout_sec=5)
spiral = Spiral()
for _ in range(20):
    answer = ask.call_async(GetParameters.Request(names=["growth"]))
    rclpy.spin_until_future_complete(node, answer, timeout_sec=2.0)
    spiral.growth = answer.result().values[0].double_value
    velocity.publish(spiral.command())
    end = node.get_clock().now() + Duration(seconds=0.5)
    while node.get_clock().now() < end:
        rclpy.spin_once(node, timeout_sec=0.01)
velocity.publish(Twist())
end = node.get_clock().now() + Duration(seconds=10)
while node.get_clock().now() < end:
    rclpy.spin_once(node, timeout_sec=0.1)
