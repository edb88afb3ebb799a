"""A double of ROS's `launch.some_substitutions_type`."""

from launch._core import unknown

SomeSubstitutionsType = object
__getattr__ = unknown("launch.some_substitutions_type")
