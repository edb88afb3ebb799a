import rclpy
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String


class Publisher(Node):
    def __init__(self):
        super().__init__("minimal_publisher")
        self.pub = self.create_publisher(String, "topic", 10)
        self.create_timer(0.5, self.tick)
        self.i = 0

    def tick(self):
        m = String(data=f"Hello World: {self.i}")
        self.pub.publish(m)
        self.get_logger().info(f'Publishing: "{m.data}"')
        self.i += 1


class Subscriber(Node):
    """To see whether something arrives."""

    def __init__(self):
        super().__init__("minimal_subscriber")
        self.create_subscription(String, "topic", self.hear, 10)

    def hear(self, m):
        self.get_logger().info(f'I heard: "{m.data}"')


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    for node in (Publisher(), Subscriber()):
        executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


main()
