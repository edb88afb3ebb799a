"""Ask a service for a sum."""

import sys

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node


class AdditionClient(Node):
    """Asks add_two_ints."""

    def __init__(self):
        super().__init__("minimal_client")
        self.client = self.create_client(AddTwoInts, "add_two_ints")
        while not self.client.wait_for_service(timeout_sec=1.0):
            self.get_logger().info("add_two_ints is not there yet")

    def ask(self, a: int, b: int):
        """Return the answer of the service."""
        future = self.client.call_async(AddTwoInts.Request(a=a, b=b))
        rclpy.spin_until_future_complete(self, future)
        return future.result()


def main():
    """Ask once, log the answer, end."""
    rclpy.init()
    node = AdditionClient()
    a, b = int(sys.argv[1]), int(sys.argv[2])
    answer = node.ask(a, b)
    node.get_logger().info(f"Result of add_two_ints: for {a} + {b} = {answer.sum}")
    rclpy.shutdown()


if __name__ == "__main__":
    main()
