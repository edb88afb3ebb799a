from launch import LaunchDescription
from launch.actions import TimerAction
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([
        Node(package='py_pubsub', executable='hear'),
        TimerAction(period=1.0, actions=[Node(package='py_pubsub', executable='speak')]),
    ])
