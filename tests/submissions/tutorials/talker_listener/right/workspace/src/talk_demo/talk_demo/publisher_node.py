from rclpy.node import Node
from std_msgs.msg import String
from talk_tools.running import run


class PublisherNode(Node):

    def __init__(self):
        super().__init__('minimal_publisher')
        self._publisher = self.create_publisher(String, 'topic', 10)
        self._timer = self.create_timer(0.5, self._publish_next)
        self._counter = 0

    def _publish_next(self):
        msg = String()
        msg.data = 'Hello World: {}'.format(self._counter)
        self._publisher.publish(msg)
        self.get_logger().info('Publishing: "{}"'.format(msg.data))
        self._counter += 1


def main(args=None):
    run(PublisherNode, args)
