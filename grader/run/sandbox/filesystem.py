"""Builds the file system that a submission's process sees, and nothing else.

The process itself builds it, by the steps that `.view` has planned in the grader; each is a list of
a word, a path and perhaps something more.

| step | what it makes |
|---|---|
| `folder` | an empty folder |
| `file` | a small file with this text |
| `link` | a symbolic link to this place |
| `bind` | the folder, file or device at the same path outside, with all that is mounted in it |
| `hide` | an empty folder in place of what a `bind` would show |
| `copy` | a writable copy of the folder outside: its room, and its owner or -1 |
| `scratch` | an empty writable folder, of so many bytes and files |
| `proc` | the processes of our namespace |

All is read-only but `copy` and `scratch`; there are no devices but in /dev; no program gets rights
of its owner. It works without capabilities in the first user namespace.

Of several programs of a submission the first builds it, and the others join it (`share`, `join`):
they have the same files, and each the processes of its own namespace.
"""

# ruff: noqa: PTH101, PTH102, PTH109, PTH115, PTH123, PTH211
# Importing pathlib would take longer than all the rest.

from __future__ import annotations

import errno
import os
import socket
import stat
from collections.abc import Sequence

from grader.system import linux

#: Where the new root is built: a folder that every system has, and that is hidden in the new one.
SITE = "/sys"
_QUIET = linux.MS_NOSUID | linux.MS_NODEV
_LIMITED = linux.MOUNT_ATTR_RDONLY | linux.MOUNT_ATTR_NOSUID | linux.MOUNT_ATTR_NODEV
#: Flags of a mount, as statvfs has them, that have to stay when it is mounted again.
_KEPT = {8: linux.MS_NOEXEC, 1024: 1024, 2048: 2048, 4096: 1 << 21}


def enter(steps: Sequence[Sequence[str]]) -> None:
    """Change to a new root with just these things in it; the current folder keeps its path.

    Args:
        steps: parents come before their contents.
    """
    folder = os.getcwd()
    linux.unshare(linux.CLONE_NEWNS)
    linux.mount("", "/", linux.MS_REC | linux.MS_PRIVATE)
    mask = os.umask(0o022)
    linux.mount("tmpfs", SITE, _QUIET, "size=1m,nr_inodes=4096,mode=755")
    for step in steps:
        _do(*step)
    os.chdir(SITE)
    linux.change_root()
    _limit(steps)
    os.umask(mask)
    os.chdir(folder)


def share(meeting: int, others: int) -> None:
    """Hand this process's view to so many others at the other end of a socket; close this end."""
    view = os.open("/proc/self/ns/mnt", os.O_RDONLY | os.O_CLOEXEC)
    with socket.socket(fileno=meeting) as ours:
        for _ in range(others):
            socket.send_fds(ours, [b"."], [view])
    os.close(view)


def join(meeting: int) -> None:
    """Wait for the view that another process shares, and change to it; see `share`."""
    folder = os.getcwd()
    with socket.socket(fileno=meeting) as ours:
        _, views, _, _ = socket.recv_fds(ours, 1, 1)
    if not views:
        raise OSError(errno.ECONNRESET, "the first of its programs has ended", "join")
    linux.enter(views[0], linux.CLONE_NEWNS)
    os.close(views[0])
    linux.unshare(linux.CLONE_NEWNS)
    linux.mount("proc", "/proc", _QUIET | linux.MS_NOEXEC | linux.MS_RDONLY)
    os.chdir(folder)


def _do(kind: str, path: str, more: str = "") -> None:
    there = SITE + path
    if kind == "folder":
        os.mkdir(there)
    elif kind == "file":
        with open(there, "w", encoding="utf-8") as file:
            file.write(more)
    elif kind == "link":
        os.symlink(more, there)
    elif kind == "bind":
        linux.mount("", there, linux.MS_BIND | linux.MS_REC, source=path)
    elif kind == "hide":
        linux.mount("tmpfs", there, _QUIET, "size=64k,nr_inodes=256,mode=755")
    elif kind == "scratch":
        linux.mount("tmpfs", there, _QUIET, f"{more},mode=1777")
    elif kind == "copy":
        options, owner = more.split(" ")
        linux.mount("tmpfs", there, _QUIET, f"{options},mode=755")
        copy_tree(path, there, int(owner))
    elif kind == "proc":
        linux.mount("proc", there, _QUIET | linux.MS_NOEXEC)


def copy_tree(source: str, target: str, owner: int = -1) -> None:
    """Copy the contents of a folder into an empty one, writable by its owner.

    Files, folders, and links as they are: a submission's private copy has nothing else.

    Args:
        owner: the user that is to own all of it; -1: the process's user.
    """
    with os.scandir(source) as entries:
        for entry in entries:
            there = f"{target}/{entry.name}"
            if entry.is_symlink():
                os.symlink(os.readlink(entry.path), there)
            elif entry.is_dir():
                os.mkdir(there)
                copy_tree(entry.path, there, owner)
                continue
            else:
                with open(entry.path, "rb") as read, open(there, "wb") as written:
                    while chunk := read.read(1 << 20):
                        written.write(chunk)
                os.chmod(there, stat.S_IMODE(entry.stat().st_mode) | stat.S_IWUSR)
            if owner >= 0:
                os.chown(there, owner, owner, follow_symlinks=False)
    os.chmod(target, 0o755)
    if owner >= 0:
        os.chown(target, owner, owner)


def _limit(steps: Sequence[Sequence[str]]) -> None:
    writable = [step[1] for step in steps if step[0] in ("copy", "scratch")]
    devices = [step[1] for step in steps if step[0] == "bind" and step[1].startswith("/dev/")]
    try:
        linux.change_mount("/", _LIMITED, below=True)
    except OSError as error:
        if error.errno != errno.ENOSYS:
            raise
        _limit_each({*writable, *devices}, set(devices))
        return
    for path in writable:
        linux.change_mount(path, 0, linux.MOUNT_ATTR_RDONLY)
    for path in devices:
        linux.change_mount(path, 0, linux.MOUNT_ATTR_NODEV | linux.MOUNT_ATTR_RDONLY)


def _limit_each(writable: set[str], devices: set[str]) -> None:
    """Limit one mount after the other, where the kernel knows no mount_setattr."""
    with open("/proc/self/mountinfo", "rb") as file:
        places = [line.split()[4].decode("unicode_escape") for line in file]
    for place in places:
        path = place.encode("latin-1").decode("utf-8", "surrogateescape")
        flags = linux.MS_BIND | linux.MS_REMOUNT | linux.MS_NOSUID
        flags |= 0 if path in writable else linux.MS_RDONLY
        flags |= 0 if path in devices else linux.MS_NODEV
        before = os.statvfs(path).f_flag
        flags |= sum(flag for bit, flag in _KEPT.items() if before & bit)
        linux.mount("", path, flags)
