"""Start both nodes. Fill in the TODO."""

from launch import LaunchDescription
from launch_ros.actions import Node  # noqa: F401  you will need it


def generate_launch_description():
    """Return what is started."""
    # TODO 6: a Node for each of my_turtles's programs, turtle_spawner and turtle_controller.
    return LaunchDescription([])
