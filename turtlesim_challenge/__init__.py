"""The challenge: draw a four-coloured spiral. Holds the reference solution and its command."""

from __future__ import annotations

import sys

ABOUT = """\
usage: turtle_controller [--help] [--ros-args -r FROM:=TO ...]

The reference controller: turtle1 draws a spiral in four colours and stops near the edge. A
turtlesim_node has to be running. Stop it with Ctrl-C."""


def main() -> None:
    """Run the node until Ctrl-C; --help prints the usage, and nothing is started."""
    arguments = sys.argv[1:]
    if "--ros-args" in arguments:
        arguments = arguments[: arguments.index("--ros-args")]
    if not {"-h", "--help"}.isdisjoint(arguments):
        print(ABOUT)
        return
    from turtlesim_py.ros import source

    if source.complains("turtle_controller"):
        sys.exit(source.UNUSABLE)
    from turtlesim_challenge import turtle_controller

    turtle_controller.main()
