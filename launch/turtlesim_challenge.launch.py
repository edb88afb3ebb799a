"""The simulator and a controller, on one ROS graph.

    ros2 launch turtlesim_challenge turtlesim_challenge.launch.py
    ros2 launch turtlesim_challenge turtlesim_challenge.launch.py package:=my_package

Only where ROS 2 is sourced: launch and launch_ros are not on PyPI.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Describe both nodes; the arguments choose the controller, for instance a student's."""
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "package",
                default_value="turtlesim_challenge",
                description="The package of the controller.",
            ),
            DeclareLaunchArgument(
                "executable",
                default_value="turtle_controller",
                description="The name of the controller in that package.",
            ),
            Node(package="turtlesim_py", executable="turtlesim_node", output="screen"),
            Node(
                package=LaunchConfiguration("package"),
                executable=LaunchConfiguration("executable"),
                output="screen",
            ),
        ]
    )
