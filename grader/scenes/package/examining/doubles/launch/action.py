"""A double of ROS's `launch.action`."""

from launch._core import Action, unknown

__all__ = [
    "Action",
]
__getattr__ = unknown("launch.action")
