"""Add two numbers for whoever asks. Fill in the two TODOs."""

import rclpy
from example_interfaces.srv import AddTwoInts  # noqa: F401  you will need it
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class AdditionServer(Node):
    """Serves add_two_ints."""

    def __init__(self):
        super().__init__("minimal_service")
        # TODO 1: create the service add_two_ints, of type AddTwoInts, that calls add().

    def add(self, request, response):
        """Called with each request: request.a and request.b."""
        # TODO 2: put the sum into response.sum
        return response


def main(args=None):
    """Run the node until Ctrl-C."""
    rclpy.init(args=args)
    try:
        rclpy.spin(AdditionServer())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
