"""A double of ROS's `launch.condition`."""

from launch._core import Condition, unknown

__all__ = [
    "Condition",
]
__getattr__ = unknown("launch.condition")
