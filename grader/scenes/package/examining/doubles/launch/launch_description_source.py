"""A double of ROS's `launch.launch_description_source`."""

from launch._core import LaunchDescriptionSource, unknown

__all__ = [
    "LaunchDescriptionSource",
]
__getattr__ = unknown("launch.launch_description_source")
