"""Ask a service for a sum. Fill in the three TODOs."""

import sys

import rclpy
from example_interfaces.srv import AddTwoInts  # noqa: F401  you will need it
from rclpy.node import Node


class AdditionClient(Node):
    """Asks add_two_ints."""

    def __init__(self):
        super().__init__("minimal_client")
        # TODO 1: create a client of the service add_two_ints, of type AddTwoInts, and wait until
        #         the service is there: it may come later than this node.

    def ask(self, a: int, b: int):
        """Return the answer of the service."""
        # TODO 2: send a request with a and b, spin until its answer is there, and return that.


def main():
    """Ask once, log the answer, end."""
    rclpy.init()
    node = AdditionClient()
    a, b = int(sys.argv[1]), int(sys.argv[2])
    node.ask(a, b)
    # TODO 3: log the answer:  Result of add_two_ints: for 2 + 3 = 5
    rclpy.shutdown()


if __name__ == "__main__":
    main()
