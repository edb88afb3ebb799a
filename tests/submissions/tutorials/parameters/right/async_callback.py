import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.parameter import Parameter


class MinimalParam(Node):
    def __init__(self):
        super().__init__("minimal_param_node")
        self.declare_parameters("", [("my_parameter", "world"), ("period", 1.0)])
        self.create_timer(self.get_parameter("period").value, self.greet)

    async def greet(self):
        self.get_logger().info(f"Hello {await self.name()}!")
        self.set_parameters([Parameter("my_parameter", Parameter.Type.STRING, "world")])

    async def name(self):
        return self.get_parameter("my_parameter").get_parameter_value().string_value


if __name__ == "__main__":
    rclpy.init()
    try:
        rclpy.spin(MinimalParam())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
