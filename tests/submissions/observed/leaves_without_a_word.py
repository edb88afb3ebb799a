"""Ends itself so that Python does nothing more."""

import os

import rclpy

rclpy.init()
os._exit(0)
