"""The tutorial's: two nodes of one package."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription(
        [
            Node(package="demo", executable="talker", name="talker", output="screen"),
            Node(
                package="demo",
                executable="listener",
                output="screen",
                emulate_tty=True,
                remappings=[("chatter", "/news"), ("~/state", "state")],
                parameters=[{"rate": 2.0, "names": ["a", "b"], "on": True, "text": "5", "mixed": [1, 2.5]}],
                arguments=["--fast", "--ros-args", "--log-level", "debug"],
            ),
        ]
    )
