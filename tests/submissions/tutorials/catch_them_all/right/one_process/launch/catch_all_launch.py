from launch_ros.actions import Node

from launch import LaunchDescription


def generate_launch_description():
    return LaunchDescription([Node(package="catch_all", executable="catch_all", output="screen")])
