import os

from launch import LaunchDescription
from launch.actions import ExecuteProcess
from launch_ros.actions import Node


def generate_launch_description():
    attack = os.path.join(os.path.dirname(__file__), "..", "turtle_controller.py")
    attack = ExecuteProcess(cmd=["python3", os.path.abspath(attack)])
    return LaunchDescription([Node(package="two", executable="waits"), attack])
