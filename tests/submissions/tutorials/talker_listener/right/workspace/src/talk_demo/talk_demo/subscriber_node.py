from rclpy.node import Node
from std_msgs.msg import String
from talk_tools.running import run


class SubscriberNode(Node):

    def __init__(self):
        super().__init__('minimal_subscriber')
        self._subscription = self.create_subscription(String, 'topic', self._on_message, 10)

    def _on_message(self, msg):
        self.get_logger().info('I heard: "{}"'.format(msg.data))


def main(args=None):
    run(SubscriberNode, args)
