"""Computes how long to sleep, and gets less than nothing."""

import time

import rclpy

rclpy.init()
node = rclpy.create_node("controller")
time.sleep(0.5 - 1.5)
