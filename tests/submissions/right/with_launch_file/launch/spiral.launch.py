from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription(
        [
            Node(package="turtlesim", executable="turtlesim_node"),
            Node(
                package="with_launch_file",
                executable="painter",
                name="painter",
                output="screen",
                parameters=[{"turn": 1.4, "margin": 1.2}],
            ),
        ]
    )
