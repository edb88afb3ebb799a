"""Shows a page in a browser, where there is one."""

from __future__ import annotations

import os
import sys
import webbrowser


def show(address: str) -> bool:
    """Open an address, if a browser would show it on this machine's screen; whether one would."""
    if not has_browser():
        return False
    return webbrowser.open(address)


def has_browser() -> bool:
    """Whether a browser would show on this machine's screen, and not in this terminal."""
    if os.name == "nt" or sys.platform == "darwin":
        return True
    return any(os.environ.get(name) for name in ("BROWSER", "DISPLAY", "WAYLAND_DISPLAY"))
