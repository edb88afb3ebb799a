from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import IncludeLaunchDescription, LogInfo
from launch.launch_description_sources import PythonLaunchDescriptionSource


def generate_launch_description():
    share = Path(get_package_share_directory("turtle_chase"))
    nodes = str(share / "launch" / "nodes.launch.py")
    return LaunchDescription(
        [
            LogInfo(msg="The chase begins"),
            IncludeLaunchDescription(PythonLaunchDescriptionSource(nodes)),
        ]
    )
