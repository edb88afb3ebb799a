"""Fills 1.5 GiB of memory that a process shares with its children: no limit of one counts it."""

import mmap

import rclpy

rclpy.init()
node = rclpy.create_node("greedy")
kept = mmap.mmap(-1, 1536 << 20)
for at in range(0, len(kept), 4 << 20):
    kept[at : at + (4 << 20)] = b"x" * (4 << 20)
rclpy.spin(node)
