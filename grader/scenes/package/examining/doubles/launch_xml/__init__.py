"""A double of ROS's package `launch_xml`."""

from launch._core import unknown

__getattr__ = unknown("launch_xml")
