"""Show the walker in RViz, with its joints at the hand of a slider."""

import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition, UnlessCondition
from launch.substitutions import Command, LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue


def generate_launch_description():
    share = get_package_share_directory("walker_description")
    model = os.path.join(share, "urdf", "walker.urdf.xacro")
    settings = os.path.join(share, "rviz", "walker.rviz")
    gui = LaunchConfiguration("gui")
    description = ParameterValue(Command(["xacro ", model]), value_type=str)
    return LaunchDescription(
        [
            DeclareLaunchArgument("gui", default_value="true"),
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                parameters=[{"robot_description": description}],
            ),
            Node(
                package="joint_state_publisher_gui",
                executable="joint_state_publisher_gui",
                condition=IfCondition(gui),
            ),
            Node(
                package="joint_state_publisher",
                executable="joint_state_publisher",
                condition=UnlessCondition(gui),
            ),
            Node(package="rviz2", executable="rviz2", arguments=["-d", settings]),
        ]
    )
