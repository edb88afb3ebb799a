"""A double of ROS's `launch.logging`: Python's own."""

from logging import getLogger as get_logger

from launch._core import unknown

__all__ = [
    "get_logger",
]
__getattr__ = unknown("launch.logging")
