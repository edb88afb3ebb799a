from launch_ros.actions import Node

from launch import LaunchDescription


def generate_launch_description():
    return LaunchDescription(
        [
            Node(
                package="catch_all",
                executable="catch_all",
                remappings=[("cmd_vel", "/turtle1/cmd_vel"), ("pose", "/turtle1/pose")],
            )
        ]
    )
