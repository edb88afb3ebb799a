"""Add two numbers for whoever asks."""

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class AdditionServer(Node):
    """Serves add_two_ints."""

    def __init__(self):
        super().__init__("minimal_service")
        self.create_service(AddTwoInts, "add_two_ints", self.add)

    def add(self, request, response):
        """Answer with the sum."""
        response.sum = request.a + request.b
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
