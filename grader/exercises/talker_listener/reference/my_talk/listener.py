"""Log what is said."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class MinimalSubscriber(Node):
    """Logs each text that it hears."""

    def __init__(self):
        super().__init__("minimal_subscriber")
        self.create_subscription(String, "topic", self.listen, 10)

    def listen(self, message: String):
        """Log the text of a message."""
        self.get_logger().info(f'I heard: "{message.data}"')


def main(args=None):
    """Run the node until Ctrl-C."""
    rclpy.init(args=args)
    try:
        rclpy.spin(MinimalSubscriber())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
