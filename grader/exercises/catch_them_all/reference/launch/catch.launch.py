"""Start both nodes."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    """Return what is started."""
    return LaunchDescription(
        [
            Node(package="my_turtles", executable="turtle_spawner"),
            Node(package="my_turtles", executable="turtle_controller"),
        ]
    )
