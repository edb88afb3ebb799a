import queue
import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Hearer(Node):
    def __init__(self):
        super().__init__('minimal_subscriber')
        self.inbox = queue.Queue()
        self.create_subscription(String, 'topic', self.inbox.put, 10)
        threading.Thread(target=self.work, daemon=True).start()

    def work(self):
        while True:
            msg = self.inbox.get()
            self.get_logger().info(f'I heard: "{msg.data}"')


def main():
    rclpy.init()
    try:
        rclpy.spin(Hearer())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
