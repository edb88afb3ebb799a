# In the form of the ROS 2 tutorial's program.
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter


class GreetingNode(Node):

    def __init__(self):
        super().__init__('minimal_param_node')
        self.declare_parameter('my_parameter', 'world')
        self.greeting_timer = self.create_timer(1.0, self.greet)

    def greet(self):
        value = self.get_parameter('my_parameter').get_parameter_value().string_value
        self.get_logger().info(f'Hello {value}!')

        back = Parameter('my_parameter', Parameter.Type.STRING, 'world')
        self.set_parameters([back])


def main():
    rclpy.init()
    greeting_node = GreetingNode()
    rclpy.spin(greeting_node)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
