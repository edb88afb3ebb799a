import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class MinimalPublisher(Node):
    def __init__(self):
        super().__init__("minimal_publisher")
        self.publisher = self.create_publisher(String, "topic", 10)
        self.timer = self.create_timer(0.5, self.callback)
        self.i = 0

    async def callback(self):
        text = await self.next_text()
        self.publisher.publish(String(data=text))
        self.get_logger().info(f'Publishing: "{text}"')

    async def next_text(self):
        self.i += 1
        return f"Hello World: {self.i - 1}"


if __name__ == "__main__":
    rclpy.init()
    try:
        rclpy.spin(MinimalPublisher())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
