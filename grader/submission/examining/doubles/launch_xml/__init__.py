"""A double of ROS's package `launch_xml`."""

from launch._core import FrontendLaunchDescriptionSource, module, unknown


class XMLLaunchDescriptionSource(FrontendLaunchDescriptionSource):
    pass


launch_description_sources = module(
    "launch_xml.launch_description_sources", XMLLaunchDescriptionSource
)
__getattr__ = unknown("launch_xml")
