import os

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node


def generate_launch_description():
    config = os.path.join(get_package_share_directory("greetings"), "config", "greetings.yaml")
    topic = LaunchConfiguration("topic")
    return LaunchDescription([
        DeclareLaunchArgument("topic", default_value="topic"),
        Node(
            package="greetings",
            executable="talk",
            name="minimal_publisher",
            parameters=[config],
            remappings=[("chatter", topic)],
        ),
        Node(
            package="greetings",
            executable="hear",
            name="minimal_subscriber",
            remappings=[("chatter", topic)],
        ),
    ])
