"""A double of ROS's `launch.some_actions_type`."""

from launch._core import unknown

SomeActionsType = object
__getattr__ = unknown("launch.some_actions_type")
