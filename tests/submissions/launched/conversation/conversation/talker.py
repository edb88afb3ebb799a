"""Talks a hundred times a second; what it has said first is kept for those who come late."""

import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.create_publisher(String, "topic_of_the_day", kept).publish(String(data="weather"))
        self.publisher = self.create_publisher(String, "chatter", 10)
        self.count = 0
        self.create_timer(0.01, self.talk)

    def talk(self):
        self.publisher.publish(String(data=f"hello {self.count}"))
        self.count += 1


def main():
    rclpy.init()
    rclpy.spin(Talker())
