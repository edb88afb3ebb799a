"""The turtlesim tutorial's: two simulators in namespaces, and what goes between them."""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription(
        [
            Node(
                package="turtlesim",
                namespace="turtlesim1",
                executable="turtlesim_node",
                name="sim",
                arguments=["--ros-args", "--log-level", "info"],
            ),
            Node(
                package="turtlesim",
                namespace="turtlesim2",
                executable="turtlesim_node",
                name="sim",
                ros_arguments=["--log-level", "warn"],
            ),
            Node(
                package="demo",
                executable="talker",
                name="mimic",
                remappings=[
                    ("/input/pose", "/turtlesim1/turtle1/pose"),
                    ("/output/cmd_vel", "/turtlesim2/turtle1/cmd_vel"),
                ],
            ),
            Node(package="rqt_graph", executable="rqt_graph"),
            Node(package="demo", executable="listener", exec_name="ears"),
        ]
    )
