"""Log what is said. Fill in the TODOs."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class MinimalSubscriber(Node):
    """Logs each text that it hears."""

    def __init__(self):
        super().__init__("minimal_subscriber")
        # TODO 3: create a subscription to topic, of type String, that calls listen().

    def listen(self, message: String):
        """Called with each message."""
        # TODO 4: log its text:  I heard: "Hello World: 0"


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
