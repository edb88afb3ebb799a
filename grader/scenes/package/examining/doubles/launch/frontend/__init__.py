"""A double of ROS's `launch.frontend`: extensions of it are not followed."""

from launch._core import unknown

__getattr__ = unknown("launch.frontend")
