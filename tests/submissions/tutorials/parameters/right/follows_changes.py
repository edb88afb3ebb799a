"""Learns of a new value when it is set, instead of asking for it."""

import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.parameter import Parameter


class MinimalParam(Node):
    def __init__(self):
        super().__init__("minimal_param_node")
        self.whom = self.declare_parameter("my_parameter", "world").value
        self.add_on_set_parameters_callback(self.on_set)
        self.create_timer(1.0, self.greet)

    def on_set(self, parameters):
        for parameter in parameters:
            if parameter.name == "my_parameter":
                if parameter.type_ != Parameter.Type.STRING:
                    return SetParametersResult(successful=False, reason="a text, please")
                self.whom = parameter.value
        return SetParametersResult(successful=True)

    def greet(self):
        self.get_logger().info(f"Hello {self.whom}!")
        self.set_parameters([Parameter("my_parameter", Parameter.Type.STRING, "world")])


def main():
    rclpy.init()
    try:
        rclpy.spin(MinimalParam())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
