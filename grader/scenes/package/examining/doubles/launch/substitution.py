"""A double of ROS's `launch.substitution`."""

from launch._core import Substitution, unknown

__all__ = [
    "Substitution",
]
__getattr__ = unknown("launch.substitution")
