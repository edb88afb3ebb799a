import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Listener(Node):
    def __init__(self):
        super().__init__("listener")
        self.sub = self.create_subscription(String, "chatter", self.hear, 10)

    def hear(self, msg):
        self.get_logger().info(f'I heard: "{msg.data}"')


def main(args=None):
    try:
        rclpy.init(args=args)
        rclpy.spin(Listener())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
