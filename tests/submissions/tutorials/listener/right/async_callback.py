import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class MinimalSubscriber(Node):
    def __init__(self):
        super().__init__("minimal_subscriber")
        self.create_subscription(String, "topic", self.heard, 10)

    async def heard(self, msg):
        await self.write(msg.data)

    async def write(self, text):
        self.get_logger().info('I heard: "%s"' % text)


def main():
    rclpy.init()
    try:
        rclpy.spin(MinimalSubscriber())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
