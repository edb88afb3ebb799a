"""Greet whoever the parameter names."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.parameter import Parameter


class MinimalParam(Node):
    """Logs a greeting each second."""

    def __init__(self):
        super().__init__("minimal_param_node")
        self.declare_parameter("my_parameter", "world")
        self.create_timer(1.0, self.greet)

    def greet(self):
        """Log the greeting, and set the parameter back."""
        name = self.get_parameter("my_parameter").value
        self.get_logger().info(f"Hello {name}!")
        self.set_parameters([Parameter("my_parameter", value="world")])


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
