"""Keeps what it hears, and logs it a little later."""

import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String


def main():
    rclpy.init()
    heard = []
    ear = Node("minimal_subscriber")
    ear.create_subscription(String, "topic", heard.append, 10)
    clock = Node("clock_of_the_subscriber")

    def tell():
        while heard:
            ear.get_logger().info(f'I heard: "{heard.pop(0).data}"')

    clock.create_timer(0.05, tell)
    executor = SingleThreadedExecutor()
    executor.add_node(ear)
    executor.add_node(clock)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
