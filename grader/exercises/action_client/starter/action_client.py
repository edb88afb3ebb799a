"""Send a goal, follow it, log what comes. Fill in the four TODOs."""

import rclpy
from example_interfaces.action import Fibonacci  # noqa: F401  you will need it
from rclpy.action import ActionClient  # noqa: F401  you will need it
from rclpy.node import Node


class FibonacciClient(Node):
    """Sends the action fibonacci a goal."""

    def __init__(self):
        super().__init__("fibonacci_action_client")
        # TODO 1: create an ActionClient of Fibonacci, called fibonacci.

    def send(self, order: int):
        """Send a goal and return its handle."""
        # TODO 2: wait for the server, send a goal of this order with follow() for its feedback, and
        #         spin until it is accepted.

    def follow(self, message):
        """Called with each feedback: message.feedback.sequence."""
        # TODO 3: log it:  Received feedback: [0, 1, 1]


def main(args=None):
    """Send a goal, log its result, end."""
    rclpy.init(args=args)
    node = FibonacciClient()
    node.send(10)
    # TODO 4: get the result of the goal, spin until it is there, and log it:  Result: [0, 1, 1, 2]
    rclpy.shutdown()


if __name__ == "__main__":
    main()
