"""Greet whoever the parameter names. Fill in the three TODOs."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.parameter import Parameter  # noqa: F401  you will need it


class MinimalParam(Node):
    """Logs a greeting each second."""

    def __init__(self):
        super().__init__("minimal_param_node")
        # TODO 1: declare my_parameter, with "world" as its default.
        self.create_timer(1.0, self.greet)

    def greet(self):
        """Called each second."""
        # TODO 2: read the parameter, and log:  Hello world!
        # TODO 3: set it back to "world".


def main(args=None):
    """Run the node until Ctrl-C."""
    rclpy.init(args=args)
    try:
        rclpy.spin(MinimalParam())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
