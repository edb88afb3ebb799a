"""Comes after a second, and is told what was said before; draws a random number."""

import random
import time

import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String


def main():
    time.sleep(1.0)
    rclpy.init()
    node = rclpy.create_node("late")
    kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(String, "topic_of_the_day", lambda m: print("first", m.data), kept)
    print("asker" in node.get_node_names(), random.random())
    rclpy.spin(node)
