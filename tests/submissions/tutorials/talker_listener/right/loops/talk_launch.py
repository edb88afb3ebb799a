from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    ld = LaunchDescription()
    for name in ['say', 'hear']:
        ld.add_action(Node(package='hello_loops', executable=name, output='screen'))
    return ld
