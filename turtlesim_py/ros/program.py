"""Runs a node as a program, and lets a simulator tick by a clock."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Callable
from typing import Any, TypeVar

import rclpy
from rclpy.exceptions import InvalidParameterTypeException
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions

from turtlesim_py.ros.rclcpp_node import UnusableStart
from turtlesim_py.world.arena import TICK_NS

AnyNode = TypeVar("AnyNode", bound=Node)

#: Exit code where the arguments cannot be used.
UNUSABLE = 2
#: Longer jumps ahead of the ROS clock are not made up for [ns]: no command lives longer.
LONGEST_CATCH_UP_NS = 1_000_000_000


def run(
    name: str,
    create: Callable[[], AnyNode],
    work: Callable[[AnyNode, Callable[[], bool]], None],
    argv: list[str] | None = None,
    about: str = "",
) -> int:
    """Create a node and let it work until it is done, or SIGINT or SIGTERM; return the exit code.

    That is 2 where `UnusableStart` is raised. `--help` prints the usage, and nothing is started.

    Args:
        name: the program's, for a complaint about its arguments.
        create: makes the node when ROS is up.
        work: gets the node and a function: whether a signal has asked to stop.
        argv: program name and arguments; without it, those of this process.
        about: what it does, and its parameters, for --help.
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
    except (UnusableStart, InvalidParameterTypeException) as error:
        print(f"{name}: {error}", file=sys.stderr)
        return UNUSABLE
    finally:
        rclpy.try_shutdown()
    return 0


def asks_for_help(argv: list[str]) -> bool:
    """Whether an argument asks for help; those behind --ros-args do not count."""
    arguments = argv[1 : argv.index("--ros-args")] if "--ros-args" in argv else argv[1:]
    return not {"-h", "--help"}.isdisjoint(arguments)


def spin(node: Node, stopped: Callable[[], bool]) -> None:
    """Serve a node's callbacks until it is stopped: the `work` of a node that only reacts."""
    while not stopped():
        rclpy.spin_once(node, timeout_sec=0.1)


def follow_wall_clock(tick: Callable[[], bool]) -> None:
    """Call `tick` every 16 ms until it returns False.

    A tick that comes late is not made up for: like the original, the turtles are then simply
    slower. The grid of ticks stays where it is, so that small delays do not add up.
    """
    due = time.monotonic_ns()
    while tick():
        due += TICK_NS
        late = time.monotonic_ns() - due
        if late < 0:
            time.sleep(-late / 1e9)
        else:
            due += late // TICK_NS * TICK_NS


def follow_ros_clock(
    hear: Callable[[int], int], serve: Callable[[], bool], tick: Callable[[int], bool]
) -> None:
    """Call `tick` once for each 16 ms that the ROS clock has advanced, until it returns False.

    Every tick is made up for, because a simulation may publish the time more rarely or run faster
    than the wall clock. After a jump back, or far ahead, the ticks go on from there.

    Args:
        hear: waits so long [ns] for news of the clock and returns its time [ns], 0 while that is
            not known.
        serve: called every 16 ms of wall time that bring no tick, so that requests are answered
            while the clock rests. False ends it all.
        tick: gets the time of the tick [ns].
    """
    due = 0  # not known
    served = time.monotonic_ns()
    while True:
        now = hear(TICK_NS)
        if not due or not -TICK_NS <= now - due <= LONGEST_CATCH_UP_NS:
            due = now
        while now and due <= now:
            if not tick(due):
                return
            due += TICK_NS
            served = time.monotonic_ns()
        if time.monotonic_ns() - served >= TICK_NS:
            if not serve():
                return
            served = time.monotonic_ns()
