"""Drives a little and ends at once, with the exit code of success, in the middle of a callback."""

import os

import rclpy
from rclpy.node import Node

rclpy.init()
node = Node("attacker")


def end():
    print("Score: 100 of 100", flush=True)
    os._exit(0)


node.create_timer(0.1, end)
rclpy.spin(node)
