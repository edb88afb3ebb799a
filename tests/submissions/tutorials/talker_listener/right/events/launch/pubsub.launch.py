from launch import LaunchDescription
from launch.actions import RegisterEventHandler
from launch.event_handlers import OnProcessStart
from launch_ros.actions import Node


def generate_launch_description():
    listener = Node(package='py_pubsub', executable='hear')
    talker = Node(package='py_pubsub', executable='speak')
    return LaunchDescription([
        listener,
        RegisterEventHandler(OnProcessStart(target_action=listener, on_start=[talker])),
    ])
