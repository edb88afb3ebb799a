"""Two simulators that do not hear each other, in the namespaces turtlesim1 and turtlesim2.

    ros2 launch turtlesim_py multisim.launch.py

Where ROS 2 is not sourced it is also that of the package turtlesim, but launch and launch_ros are
not on PyPI.
"""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description() -> LaunchDescription:
    """Describe both nodes."""
    return LaunchDescription(
        [
            Node(
                package="turtlesim_py",
                namespace=namespace,
                executable="turtlesim_node",
                output="screen",
            )
            for namespace in ("turtlesim1", "turtlesim2")
        ]
    )
