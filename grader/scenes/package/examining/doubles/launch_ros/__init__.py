"""A double of ROS's package `launch_ros`, which starts nothing; see `launch._core`."""

from launch._core import unknown
from launch_ros import actions, descriptions, parameter_descriptions, substitutions

__all__ = [
    "actions",
    "descriptions",
    "parameter_descriptions",
    "substitutions",
]
__getattr__ = unknown("launch_ros")
