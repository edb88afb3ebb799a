import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__('minimal_publisher')
        self.count = 0
        self.publisher = self.create_publisher(String, 'topic', 10)
        self.create_timer(0.5, self.on_timer)

    def on_timer(self):
        message = String(data=f'Hello World: {self.count}')
        self.count += 1
        self.publisher.publish(message)
        self.get_logger().info(f'Publishing: "{message.data}"')


def main(args=None):
    rclpy.init(args=args)
    node = Talker()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
