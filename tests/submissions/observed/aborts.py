"""Makes a mistake in C."""

import ctypes

import rclpy


def crash():
    ctypes.string_at(1)


rclpy.init()
rclpy.spin_once(rclpy.create_node("controller"), timeout_sec=0.5)
crash()
