"""A double of ROS's `launch.launch_description_entity`."""

from launch._core import LaunchDescriptionEntity, unknown

__all__ = [
    "LaunchDescriptionEntity",
]
__getattr__ = unknown("launch.launch_description_entity")
