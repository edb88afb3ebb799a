"""Say hello twice a second. Fill in the TODOs."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String  # noqa: F401  you will need it


class MinimalPublisher(Node):
    """Publishes a text that counts."""

    def __init__(self):
        super().__init__("minimal_publisher")
        # TODO 1: create a publisher of String on topic, and a timer
        #         that calls talk() twice a second.

    def talk(self):
        """Called twice a second."""
        # TODO 2: publish "Hello World: 0", then "Hello World: 1", and so on, and log each:
        #         Publishing: "Hello World: 0"


def main(args=None):
    """Run the node until Ctrl-C."""
    rclpy.init(args=args)
    try:
        rclpy.spin(MinimalPublisher())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
