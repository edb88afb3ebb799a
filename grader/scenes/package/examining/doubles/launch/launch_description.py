"""A double of ROS's `launch.launch_description`."""

from launch._core import LaunchDescription, unknown

__all__ = [
    "LaunchDescription",
]
__getattr__ = unknown("launch.launch_description")
