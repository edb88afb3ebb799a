"""Say hello twice a second."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class MinimalPublisher(Node):
    """Publishes a text that counts."""

    def __init__(self):
        super().__init__("minimal_publisher")
        self.publisher = self.create_publisher(String, "topic", 10)
        self.count = 0
        self.create_timer(0.5, self.talk)

    def talk(self):
        """Publish and log the next text."""
        text = f"Hello World: {self.count}"
        self.count += 1
        self.publisher.publish(String(data=text))
        self.get_logger().info(f'Publishing: "{text}"')


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
