"""Forks past Python until it is refused, at most 400 times, and gives others time to see it."""

import ctypes

import rclpy

libc = ctypes.CDLL(None)
rclpy.init()
node = rclpy.create_node("greedy")
for _ in range(400):
    child = libc.fork()
    if child == 0:
        libc.pause()
    if child < 0:
        break
libc.usleep(900_000)
rclpy.spin(node)
