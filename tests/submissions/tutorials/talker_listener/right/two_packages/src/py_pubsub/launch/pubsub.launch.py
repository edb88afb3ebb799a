from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([
        Node(
            package='py_pubsub',
            executable='speak',
            name='minimal_publisher',
            output='screen',
        ),
        Node(
            package='py_sub',
            executable='hear',
            name='minimal_subscriber',
            output='screen',
        ),
    ])
