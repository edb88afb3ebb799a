import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.parameter import Parameter


class ParamNode(Node):
    def __init__(self):
        super().__init__('minimal_param_node')
        self.declare_parameter('my_parameter', 'world')
        self.create_timer(1, self.on_timer)

    @property
    def my_parameter(self):
        return self.get_parameter('my_parameter').value

    def on_timer(self):
        self.get_logger().info(f'Hello {self.my_parameter}!')
        self.set_parameters([Parameter('my_parameter', Parameter.Type.STRING, 'world')])


def main(args=None):
    rclpy.init(args=args)
    node = ParamNode()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
