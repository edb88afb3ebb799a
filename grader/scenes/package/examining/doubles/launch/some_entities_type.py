"""A double of ROS's `launch.some_entities_type`."""

from launch._core import unknown

SomeEntitiesType = object
__getattr__ = unknown("launch.some_entities_type")
