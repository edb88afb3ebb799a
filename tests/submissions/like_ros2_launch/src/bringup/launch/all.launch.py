"""A bringup package built with CMake: includes in groups, YAML of its own, a program of CMake's."""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction, IncludeLaunchDescription
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import PathJoinSubstitution, ThisLaunchFileDir
from launch_ros.actions import Node, PushRosNamespace
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    config = os.path.join(get_package_share_directory("bringup"), "config", "team.yaml")
    part = PythonLaunchDescriptionSource([ThisLaunchFileDir(), "/part.launch.py"])
    two = PathJoinSubstitution([FindPackageShare("demo"), "launch", "two_nodes.launch.py"])
    return LaunchDescription(
        [
            DeclareLaunchArgument("space", default_value="team"),
            Node(package="bringup", executable="watch.py", name="watch"),
            GroupAction(
                [
                    PushRosNamespace("team"),
                    IncludeLaunchDescription(part, launch_arguments={"who": "helper"}.items()),
                    Node(package="demo", executable="talker", parameters=[config, {"rate": 1}]),
                ]
            ),
            IncludeLaunchDescription(PythonLaunchDescriptionSource(two)),
            Node(
                package="tf2_ros",
                executable="static_transform_publisher",
                arguments=["0", "0", "1", "0", "0", "0", "map", "base"],
            ),
        ]
    )
