"""Waits for what nobody offers, and is slow to say where: as if others had the processor."""

import sys

import rclpy
from turtlesim.srv import SetPen

frames = sys._current_frames


def slowly():
    for _ in range(5_000_000):
        pass
    return frames()


sys._current_frames = slowly
rclpy.init()
node = rclpy.create_node("controller")
pen = node.create_client(SetPen, "/set_pen")
while not pen.wait_for_service(timeout_sec=1.0):
    pass
