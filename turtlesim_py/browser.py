"""Opens a page in a browser, or returns how to reach it from another machine."""

from __future__ import annotations

import os
import sys
import webbrowser
from urllib.parse import urlsplit


def show(address: str) -> bool:
    """Open an address if a browser can show it on this machine's screen; return whether one can."""
    return has_browser() and webbrowser.open(address)


def has_browser() -> bool:
    """Whether a browser would show on this machine's screen, and not in this terminal."""
    if os.name == "nt" or sys.platform == "darwin":
        return True
    return any(os.environ.get(name) for name in ("BROWSER", "DISPLAY", "WAYLAND_DISPLAY"))


def tunnel(address: str) -> str:
    """Return the command that opens this machine's page where the user sits; '' if none is needed.

    Only a user who has come by ssh needs it: ssh sets SSH_CONNECTION to the addresses and ports of
    both ends, the other's first.
    """
    page = urlsplit(address)
    ends = os.environ.get("SSH_CONNECTION", "").split()
    if page.hostname != "127.0.0.1" or len(ends) != 4:
        return ""
    user = os.environ.get("USER") or os.environ.get("LOGNAME") or "you"
    machine, port = ends[2:]
    port_option = "" if port == "22" else f"-p {port} "
    return f"ssh {port_option}-L {page.port}:127.0.0.1:{page.port} {user}@{machine}"
