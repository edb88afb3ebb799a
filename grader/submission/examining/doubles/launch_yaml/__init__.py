"""A double of ROS's package `launch_yaml`."""

from launch._core import FrontendLaunchDescriptionSource, module, unknown


class YAMLLaunchDescriptionSource(FrontendLaunchDescriptionSource):
    pass


launch_description_sources = module(
    "launch_yaml.launch_description_sources", YAMLLaunchDescriptionSource
)
__getattr__ = unknown("launch_yaml")
