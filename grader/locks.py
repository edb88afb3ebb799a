"""A lock that vanishes with the process that holds it, however that ends."""

from __future__ import annotations

import importlib
import os
import stat
from pathlib import Path
from typing import IO, Any

from grader import system

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]


def open_file(path: Path) -> IO[str]:
    """Open the file of a lock, which is made if it is not there, and never changed.

    Raises:
        OSError: it cannot be opened, or is not an ordinary file of this user's: a link is not
            followed, and a pipe not waited for.
    """
    return open(path, "r+", opener=_open_own, encoding="utf-8")


def _open_own(path: str, flags: int) -> int:
    flags |= os.O_CREAT | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
    descriptor = os.open(path, flags, 0o600)
    found = os.fstat(descriptor)
    if stat.S_ISREG(found.st_mode) and system.is_own(found):
        return descriptor
    os.close(descriptor)
    raise PermissionError(f"{path} is not an ordinary file of this user's")


def take(file: IO[str]) -> bool:
    """Lock an open file, unless somebody else has it locked; held until the file is closed.

    Each `open` counts for itself, also within one process.
    """
    if fcntl is None:
        return _take_byte(file)
    return _take(file.fileno())


def is_in_place(file: IO[str], path: Path) -> bool:
    """Whether an open file is still the one of this name: another's lock may be on a new one."""
    try:
        return os.path.samestat(os.fstat(file.fileno()), path.lstat())
    except OSError:
        return False


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
