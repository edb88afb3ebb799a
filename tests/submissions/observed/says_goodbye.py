"""Leaves with a text in place of a number."""

import sys

import rclpy


def leave():
    sys.exit("bye")


rclpy.init()
leave()
