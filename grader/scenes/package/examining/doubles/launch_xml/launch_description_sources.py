"""A double of ROS's `launch_xml.launch_description_sources`."""

from launch._core import unknown
from launch.launch_description_sources import FrontendLaunchDescriptionSource


class XMLLaunchDescriptionSource(FrontendLaunchDescriptionSource):
    pass


__getattr__ = unknown("launch_xml.launch_description_sources")
