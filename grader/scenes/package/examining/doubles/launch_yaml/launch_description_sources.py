"""A double of ROS's `launch_yaml.launch_description_sources`."""

from launch._core import unknown
from launch.launch_description_sources import FrontendLaunchDescriptionSource


class YAMLLaunchDescriptionSource(FrontendLaunchDescriptionSource):
    pass


__getattr__ = unknown("launch_yaml.launch_description_sources")
