"""Files that a stranger's code may have put anywhere: looked for and read, and never waited for."""

from __future__ import annotations

import errno
import os
import stat
from contextlib import suppress
from pathlib import Path


def is_file(path: Path) -> bool:
    """Whether it is a file, whatever its name is."""
    with suppress(OSError, ValueError):  # a name that is too long, a folder that is closed
        return path.is_file()
    return False


def is_folder(path: Path) -> bool:
    """Whether it is a folder, whatever its name is."""
    with suppress(OSError, ValueError):
        return path.is_dir()
    return False


def touch(path: Path) -> None:
    """Make an empty file, with its folders, unless its name is none that a file can have."""
    with suppress(OSError, ValueError):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()


def read(path: Path, most: int) -> bytes:
    """The first bytes of a file."""
    found = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))
    with os.fdopen(found, "rb") as file:
        if not stat.S_ISREG(os.fstat(found).st_mode):
            raise OSError(errno.ENXIO, "it is no file", str(path))
        return file.read(most)
