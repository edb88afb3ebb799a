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
) -> int:
    """Create a node and let it work until it has done, or SIGINT or SIGTERM; return the exit code.

    Args:
        name: the program's, for a complaint about its arguments.
        create: makes the node when ROS is up.
        work: gets the node and a function that says whether a signal has asked to stop.
        argv: program name and arguments; without it, those of this process.
    """
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


def spin(node: Node, stopped: Callable[[], bool]) -> None:
    """Serve a node's callbacks until it is stopped: the `work` of a node that only reacts."""
    while not stopped():
        rclpy.spin_once(node, timeout_sec=0.1)
