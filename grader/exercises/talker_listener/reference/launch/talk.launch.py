"""Start both nodes."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    """Return what is started."""
    return LaunchDescription(
        [
            Node(package="my_talk", executable="talker"),
            Node(package="my_talk", executable="listener"),
        ]
    )
