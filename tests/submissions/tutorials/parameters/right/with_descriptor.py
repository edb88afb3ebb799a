import rclpy
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter


class Greeter(Node):
    DEFAULT = "world"

    def __init__(self):
        super().__init__("minimal_param_node")
        self.declare_parameter(
            "my_parameter", self.DEFAULT, ParameterDescriptor(description="Whom to greet")
        )
        self.timer = self.create_timer(1.0, self.greet)

    def greet(self):
        whom = self.get_parameter("my_parameter").value
        self.get_logger().info(f"Hello {whom}!")
        if whom != self.DEFAULT:
            self.set_parameters_atomically([Parameter("my_parameter", value=self.DEFAULT)])


def main():
    rclpy.init()
    executor = MultiThreadedExecutor()
    executor.add_node(Greeter())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
