"""A double of ROS's package `launch_yaml`."""

from launch._core import unknown

__getattr__ = unknown("launch_yaml")
