from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription(
        [
            Node(package="turtlesim", executable="turtlesim_node", name="sim"),
            Node(package="spiral", executable="turtle_controller", output="screen"),
            Node(
                package="spiral",
                executable="pen_node",
                name="pens",
                parameters=[{"width": 5}],
                remappings=[("pose", "/turtle1/pose")],
            ),
        ]
    )
