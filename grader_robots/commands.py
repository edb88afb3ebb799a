"""The commands of the nodes of robots, started as those of turtles are."""

from __future__ import annotations

from turtlesim_py.commands import start


def robot_state_publisher() -> int:
    """Tell where the links of a robot are."""
    return start("robot_state_publisher", "grader_robots.robot_py.robot_state_publisher")


def joint_state_publisher() -> int:
    """Publish the positions of joints."""
    return start("joint_state_publisher", "grader_robots.robot_py.joint_state_publisher")
