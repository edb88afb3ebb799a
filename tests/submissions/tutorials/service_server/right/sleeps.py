"""Takes half a second over an answer."""

import time

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class SlowAdder(Node):
    def __init__(self):
        super().__init__("slow_adder")
        self.create_service(AddTwoInts, "add_two_ints", self.add)

    def add(self, request, response):
        self.get_logger().info("Let me think ...")
        time.sleep(0.5)
        response.sum = request.a + request.b
        self.get_logger().info(f"It is {response.sum}")
        return response


if __name__ == "__main__":
    rclpy.init()
    try:
        rclpy.spin(SlowAdder())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    rclpy.try_shutdown()
