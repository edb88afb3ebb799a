"""Dies hard after two seconds; its random numbers are its own."""

import os
import random
import time

import rclpy


def main():
    rclpy.init()
    node = rclpy.create_node("dies")
    print(random.random())
    time.sleep(2.0)
    print(sorted(node.get_node_names()), flush=True)
    os._exit(3)
