"""A double of ROS's package `launch_ros`, which starts nothing; see `launch._core`."""

from launch._core import unknown
from launch_ros import actions, parameter_descriptions, substitutions
from launch_ros.parameter_descriptions import descriptions

__all__ = [
    "actions",
    "descriptions",
    "parameter_descriptions",
    "substitutions",
]
__getattr__ = unknown("launch_ros")
