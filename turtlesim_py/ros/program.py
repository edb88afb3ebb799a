"""What every program of this package does around its node."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable
from typing import Any, TypeVar

import rclpy
from rclpy.exceptions import InvalidParameterTypeException
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from turtlesim_py.ros.rclcpp_node import UnusableParameter

AnyNode = TypeVar("AnyNode", bound=Node)

#: Exit code where the arguments cannot be used.
UNUSABLE = 2


def run(
    name: str,
    create: Callable[[], AnyNode],
    work: Callable[[AnyNode, Callable[[], bool]], None],
    argv: list[str] | None = None,
    about: str = "",
) -> int:
    """Create a node and let it work until it has done, or SIGINT or SIGTERM; return the exit code.

    Who asks for help gets it, and nothing is started.

    Args:
        name: the program's, for a complaint about its arguments.
        create: makes the node when ROS is up.
        work: gets the node and a function that says whether a signal has asked to stop.
        argv: program name and arguments; without it, those of this process.
        about: what it does, and its parameters, for who asks.
    """
    if asks_for_help(sys.argv if argv is None else argv):
        print(f"usage: {name} [--help] [--ros-args -p NAME:=VALUE -r FROM:=TO ...]\n\n{about}")
        return 0
    stop = False

    def on_signal(*_: Any) -> None:
        nonlocal stop
        stop = True

    signal.signal(signal.SIGINT, on_signal)
    signal.signal(signal.SIGTERM, on_signal)
    try:
        rclpy.init(args=argv, signal_handler_options=SignalHandlerOptions.NO)
    except RuntimeError as error:  # rcl's, about ROS arguments
        print(f"{name}: cannot use the ROS arguments: {error}", file=sys.stderr)
        return UNUSABLE
    try:
        node = create()
        work(node, lambda: stop)
        node.destroy_node()
    except (UnusableParameter, InvalidParameterTypeException) as error:
        print(f"{name}: {error}", file=sys.stderr)
        return UNUSABLE
    finally:
        rclpy.try_shutdown()
    return 0


def asks_for_help(argv: list[str]) -> bool:
    """Whether a word of the program's own, not one of ROS's, asks for help."""
    own = argv[1 : argv.index("--ros-args")] if "--ros-args" in argv else argv[1:]
    return not {"-h", "--help"}.isdisjoint(own)


def spin(node: Node, stopped: Callable[[], bool]) -> None:
    """Serve a node's callbacks until it is stopped: the `work` of a node that only reacts."""
    while not stopped():
        rclpy.spin_once(node, timeout_sec=0.1)
