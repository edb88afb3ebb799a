"""A double of ROS's `launch.launch_context`."""

from launch._core import LaunchContext, unknown

__all__ = [
    "LaunchContext",
]
__getattr__ = unknown("launch.launch_context")
