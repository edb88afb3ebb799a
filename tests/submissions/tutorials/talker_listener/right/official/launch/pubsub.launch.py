from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([
        Node(
            package='py_pubsub',
            executable='talker',
            name='minimal_publisher',
            output='screen',
        ),
        Node(
            package='py_pubsub',
            executable='listener',
            name='minimal_subscriber',
            output='screen',
        ),
    ])
