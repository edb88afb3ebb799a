"""A lock that vanishes with the process that holds it, however that ends."""

from __future__ import annotations

import importlib
import os
from pathlib import Path
from typing import IO, Any

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]


def take(file: IO[str]) -> bool:
    """Lock an open file, unless somebody else has it locked; held until the file is closed.

    Each `open` counts for itself, also within one process.
    """
    if fcntl is None:
        return _take_byte(file)
    return _take(file.fileno())


def take_folder(folder: Path) -> int | None:
    """Lock a folder, unless somebody else has it locked; Windows cannot, and lets anybody.

    Returns:
        A descriptor to be closed, which ends the lock; None where somebody else has it.
    """
    if fcntl is None:
        return os.open(os.devnull, os.O_RDONLY)
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    if _take(descriptor):
        return descriptor
    os.close(descriptor)
    return None


def _take(descriptor: int) -> bool:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
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
