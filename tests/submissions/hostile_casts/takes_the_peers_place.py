"""Serves what a peer serves, and asks itself; sets what a peer has not."""

import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from rcl_interfaces.srv import SetParameters
from rclpy.action import ActionServer
from std_msgs.msg import Float64

rclpy.init()
node = rclpy.create_node("node")


def add(_, response):
    response.sum = 1
    return response


def count(handle):
    handle.succeed()
    return Fibonacci.Result()


node.create_service(AddTwoInts, "divide", add)
server = ActionServer(node, Fibonacci, "fibonacci", count)
data = node.create_publisher(Float64, "data", 10)
out = node.create_publisher(Float64, "out", 10)
sets = node.create_client(SetParameters, "/peer/set_parameters")
print(sets.wait_for_service(timeout_sec=1.0))


def say():
    data.publish(Float64(data=0.0))
    out.publish(Float64(data=0.0))


node.create_timer(0.1, say)
rclpy.spin(node)
