"""A lock that vanishes with the process that holds it, however that ends."""

from __future__ import annotations

import importlib
from typing import IO, Any

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]


def take(file: IO[str] | int) -> bool:
    """Lock an open file, unless somebody else has it locked; held until the file is closed.

    Elsewhere than on Windows a descriptor will do.

    Each `open` counts for itself, also within one process.
    """
    if fcntl is None:
        assert not isinstance(file, int)
        return _take_byte(file)
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _take_byte(file: IO[str]) -> bool:
    """Windows locks bytes, also such as the file does not have."""
    windows: Any = importlib.import_module("msvcrt")  # mypy reads it on Windows only
    try:
        windows.locking(file.fileno(), windows.LK_NBLCK, 1)
    except OSError:
        return False
    return True
