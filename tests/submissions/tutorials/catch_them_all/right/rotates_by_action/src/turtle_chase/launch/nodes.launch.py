from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    names = ["turtle_spawner", "turtle_controller"]
    return LaunchDescription([Node(package="turtle_chase", executable=name) for name in names])
