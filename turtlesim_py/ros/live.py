"""The parameters of the page on which the turtles can be seen, and its server if one is wanted."""

from __future__ import annotations

import sys
from functools import partial
from typing import TYPE_CHECKING

from turtlesim_py.ros.rclcpp_node import RclcppNode, UnusableParameter
from turtlesim_py.world.arena import Arena

if TYPE_CHECKING:
    from turtlesim_py.live.feed import Feed
    from turtlesim_py.live.server import LiveServer

#: Nobody but this machine.
DEFAULT_HOST = "127.0.0.1"
#: So long the server's thread may keep a tick waiting [s]; Python's 5 ms are a third of a tick.
SWITCH_S = 0.0005


def declare_parameters(node: RclcppNode) -> None:
    """Declare what `serve` reads."""
    node.declare(
        "view_port",
        -1,
        "Where a page shows the turtles: a port of this machine; 0: any free one; -1: no page",
        limits=(-1, 65535),
        read_only=True,
    )
    node.declare("view_host", DEFAULT_HOST, "The address to serve the page at", read_only=True)
    node.declare("view_token", "", "What opens the page elsewhere; empty: made", read_only=True)
    node.declare("view_read_only", False, "Whether the page is for looking only", read_only=True)


def serve(node: RclcppNode, arena: Arena, interfaces: str) -> LiveServer[Feed] | None:
    """Begin to serve the page; None where none is wanted.

    Args:
        interfaces: the package of turtlesim's messages.

    Raises:
        UnusableParameter: it cannot be served so.
    """
    port: int = node.get_parameter("view_port").value
    if port < 0:
        return None
    try:
        from turtlesim_py.live.feed import Feed  # here: few want a page
        from turtlesim_py.live.server import LiveServer, Settings
    except ImportError as error:
        needed = f"-1: a page needs the package websockets, 13.1 or newer ({error})"
        raise UnusableParameter("view_port", port, needed) from None
    host: str = node.get_parameter("view_host").value
    settings = Settings(
        port,
        host,
        node.get_parameter("view_read_only").value,
        node.get_parameter("view_token").value,
    )
    about = {
        "node": node.get_fully_qualified_name(),
        "namespace": node.get_namespace(),
        "interfaces": interfaces,
    }
    sys.setswitchinterval(SWITCH_S)
    server = LiveServer(partial(Feed, arena), settings, about)
    try:
        server.start()
    except (OSError, UnicodeError) as error:
        why = getattr(error, "strerror", None) or str(error)
        found = f"{port}, at {host}"
        raise UnusableParameter("view_port", found, f"a port that is free ({why})") from None
    node.get_logger().info(f"The turtles are to be seen at {server.address}")
    return server
