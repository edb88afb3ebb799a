import time

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.parameter import Parameter


def main():
    rclpy.init()
    node = Node("minimal_param_node")
    node.declare_parameter("my_parameter", "world")
    world = Parameter("my_parameter", Parameter.Type.STRING, "world")
    due = time.monotonic() + 1
    try:
        while rclpy.ok():
            rclpy.spin_once(node, timeout_sec=0.05)
            if time.monotonic() >= due:
                due += 1
                name = node.get_parameter_or("my_parameter", world).value
                node.get_logger().info("Hello " + name + "!")
                node.set_parameters([world])
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
