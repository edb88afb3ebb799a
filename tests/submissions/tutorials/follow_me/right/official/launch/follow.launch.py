from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([
        Node(
            package='turtlesim',
            executable='turtlesim_node',
            name='turtlesim',
        ),
        Node(
            package='turtle_follow',
            executable='spawn_turtle',
        ),
        Node(
            package='turtle_follow',
            executable='follow_turtle',
            output='screen',
        ),
    ])
