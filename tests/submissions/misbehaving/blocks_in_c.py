"""Waits inside C, where virtual time cannot see it."""

import ctypes

import rclpy

rclpy.init()
node = rclpy.create_node("controller")
ctypes.CDLL(None).sleep(1000)
