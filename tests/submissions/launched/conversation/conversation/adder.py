"""Serves."""

import rclpy
from example_interfaces.srv import AddTwoInts


def add(request, response):
    response.sum = request.a + request.b
    return response


def main():
    rclpy.init()
    node = rclpy.create_node("adder")
    node.create_service(AddTwoInts, "add", add)
    rclpy.spin(node)
