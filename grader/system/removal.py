"""Removes a file or a folder whatever a submission has made of it, and nothing beside it.

A submission's process may leave folders with mode 000, 300 levels deep, or with names that are no
text, links to anywhere, pipes and sockets, files that are immutable (root's), or still being made.
No link is followed, nothing is waited for, and a folder in another is moved up before it is opened,
so that no depth is too deep.
"""

from __future__ import annotations

import os
import stat
import uuid
from contextlib import suppress
from pathlib import Path

#: How many passes a folder gets that is still being filled.
PASSES = 3
#: Sets the attributes of a file, as chattr does; see ioctl_iflags(2).
_FS_IOC_SETFLAGS = 0x40086602
_FOLDER = os.O_RDONLY | getattr(os, "O_DIRECTORY", 0) | getattr(os, "O_NOFOLLOW", 0)


def remove(path: Path) -> bool:
    """Remove what is there; return whether nothing is left. It never fails, and never waits."""
    for _ in range(PASSES):
        with suppress(OSError):
            if not stat.S_ISDIR(path.lstat().st_mode):
                path.unlink()
            else:
                _remove_folder(path)
        if not os.path.lexists(path):
            return True
    return False


def _remove_folder(path: Path) -> None:
    top = _enter(str(path))
    try:
        _empty(top)
    finally:
        os.close(top)
    path.rmdir()


def _empty(top: int) -> None:
    """Remove the contents of an open folder, as far as possible."""
    pending = ["."]
    while pending:
        name = pending.pop()
        with suppress(OSError):
            folder = _enter(name, top)
            try:
                for entry in os.listdir(folder):  # noqa: PTH208  it has no path
                    with suppress(OSError):
                        _drop(entry, folder, top, pending)
            finally:
                os.close(folder)
            if name != ".":
                os.rmdir(name, dir_fd=top)


def _drop(entry: str, folder: int, top: int, pending: list[str]) -> None:
    """Remove an entry; a folder that is not empty is moved to the top, and becomes pending."""
    if not stat.S_ISDIR(os.stat(entry, dir_fd=folder, follow_symlinks=False).st_mode):
        try:
            os.unlink(entry, dir_fd=folder)
        except PermissionError:
            _thaw_file(entry, folder)
            os.unlink(entry, dir_fd=folder)
        return
    with suppress(OSError):
        os.rmdir(entry, dir_fd=folder)
        return
    os.close(_enter(entry, folder))  # only what may be written into can be moved
    moved = uuid.uuid4().hex
    os.rename(entry, moved, src_dir_fd=folder, dst_dir_fd=top)
    pending.append(moved)


def _enter(name: str, parent: int | None = None) -> int:
    """Open a folder, and give its owner all rights to it."""
    try:
        folder = os.open(name, _FOLDER, dir_fd=parent)
    except PermissionError:
        _permit(name, parent)
        folder = os.open(name, _FOLDER, dir_fd=parent)
    try:
        os.fchmod(folder, stat.S_IRWXU)
    except OSError:
        _thaw(folder)
    return folder


def _thaw_file(name: str, parent: int) -> None:
    flags = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK
    file = os.open(name, flags, dir_fd=parent)
    try:
        _thaw(file)
    finally:
        os.close(file)


def _thaw(opened: int) -> None:
    """Clear the attributes of an immutable file or folder."""
    import fcntl  # here: Windows lacks it

    with suppress(OSError):
        fcntl.ioctl(opened, _FS_IOC_SETFLAGS, bytes(8))
        if stat.S_ISDIR(os.fstat(opened).st_mode):
            os.fchmod(opened, stat.S_IRWXU)


def _permit(name: str, parent: int | None) -> None:
    """Give us all rights to a folder of ours; if it is a link by now, that is not followed."""
    folder = os.open(name, _FOLDER | os.O_PATH, dir_fd=parent)
    try:
        Path(f"/proc/self/fd/{folder}").chmod(stat.S_IRWXU)
    finally:
        os.close(folder)
