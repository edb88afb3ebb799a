from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([
        Node(
            package='py_pubsub',
            executable='speak',
            namespace='demo', remappings=[('topic', '/topic')],
            output='screen',
        ),
        Node(
            package='py_pubsub',
            executable='hear',
            namespace='demo', remappings=[('topic', '/topic')],
            output='screen',
        ),
    ])
