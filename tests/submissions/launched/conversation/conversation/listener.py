"""Hears the talker, and has a timer that is never due when the talker's is."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Listener(Node):
    def __init__(self):
        super().__init__("listener")
        print(sorted(self.get_node_names()), self.count_publishers("chatter"))
        self.heard = 0
        self.create_subscription(String, "chatter", self.hear, 10)
        self.create_timer(0.007, lambda: None)

    def hear(self, message):
        self.heard += 1
        if self.heard % 100 == 1:
            print(message.data, self.get_clock().now().nanoseconds % 10**12)


def main():
    rclpy.init()
    rclpy.spin(Listener())
