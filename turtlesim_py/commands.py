"""The commands: each starts its program, or says in one line what of ROS is missing."""

from __future__ import annotations

from importlib import import_module

from turtlesim_py.ros import source


def start(command: str, module: str) -> int:
    """Return the exit code of a module's main(), which is imported only where ROS can be."""
    if source.complains(command):
        return source.UNUSABLE
    code: int = import_module(module).main()
    return code


def turtlesim() -> int:
    """Run the simulator with its page."""
    return start("turtlesim", "turtlesim_py.programs.turtlesim")


def turtlesim_node() -> int:
    return start("turtlesim_node", "turtlesim_py.ros.node")


def turtle_teleop_key() -> int:
    """Drive a turtle with the keyboard."""
    return start("turtle_teleop_key", "turtlesim_py.programs.teleop_key")


def draw_square() -> int:
    """Drive a turtle along a square."""
    return start("draw_square", "turtlesim_py.programs.draw_square")


def mimic() -> int:
    return start("mimic", "turtlesim_py.programs.mimic")
