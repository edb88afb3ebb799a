from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    names = ["talker", "listener", "asker", "adder", "late", "dies"]
    return LaunchDescription([Node(package="conversation", executable=name) for name in names])
