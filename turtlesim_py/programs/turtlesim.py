"""The simulator with a page on which to see and drive the turtles: `turtlesim`."""

from __future__ import annotations

import socket
import sys
from collections.abc import Callable

from turtlesim_py import browser
from turtlesim_py.ros import node, program

#: The port of the page, unless it is in use.
USUAL_PORT = 8080
#: Printed by --help.
ABOUT = """\
The simulator, with a page that shows the turtles and drives them. Prints the page's address, and
opens it where there is a browser; Ctrl-C ends both. On another port:
    turtlesim --ros-args -p view_port:=8090
For looking only, as on a projector, and from other machines:
    turtlesim --ros-args -p view_read_only:=true -p view_host:=0.0.0.0

"""


def main(argv: list[str] | None = None) -> int:
    """Run simulator and page until SIGINT or SIGTERM; 2 where the arguments cannot be used."""
    given = list(sys.argv if argv is None else argv)
    if not any("view_port" in word for word in given):
        given += ["--ros-args", "-p", f"view_port:={_free_port()}"]
    about = ABOUT + node.ABOUT.partition("\n\n")[2]
    return program.run("turtlesim", node.TurtlesimNode, _show, given, about)


def _free_port() -> int:
    """Return the usual port; 0, for any, where it is in use."""
    with socket.socket() as tried:
        tried.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            tried.bind(("127.0.0.1", USUAL_PORT))
        except OSError:
            return 0
    return USUAL_PORT


def _show(simulator: node.TurtlesimNode, stopped: Callable[[], bool]) -> None:
    page = simulator.live
    if page is not None:
        print(f"\nThe turtles: {page.address}")
        print(f"Through a forwarded port, add to its address: {page.forwarded_address}")
        if tunnel := browser.tunnel(page.address):
            print(f"To see it where you are, type there: {tunnel}")
        print("Ctrl-C ends it.\n", flush=True)
        browser.show(page.address)
    node.simulate(simulator, stopped)


if __name__ == "__main__":
    sys.exit(main())
