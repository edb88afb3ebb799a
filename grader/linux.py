"""Calls of Linux's that Python has no name for; elsewhere each says that it is not there.

Nothing but the standard library, and little of that: processes that import this start in a few
milliseconds.
"""

from __future__ import annotations

import ctypes
import errno
import os
from typing import Any

CLONE_NEWNS, CLONE_NEWIPC, CLONE_NEWUSER = 0x00020000, 0x08000000, 0x10000000
CLONE_NEWPID, CLONE_NEWNET = 0x20000000, 0x40000000
#: As /proc/sys/user calls them.
KINDS = {
    **{CLONE_NEWNS: "mnt", CLONE_NEWIPC: "ipc", CLONE_NEWUSER: "user"},
    **{CLONE_NEWPID: "pid", CLONE_NEWNET: "net"},
}
MS_RDONLY, MS_NOSUID, MS_NODEV, MS_NOEXEC, MS_REMOUNT = 1, 2, 4, 8, 32
MS_BIND, MS_REC, MS_PRIVATE = 0x1000, 0x4000, 0x40000
MNT_DETACH = 2
MOUNT_ATTR_RDONLY, MOUNT_ATTR_NOSUID, MOUNT_ATTR_NODEV = 1, 2, 4
AT_FDCWD, AT_RECURSIVE = -100, 0x8000
PR_SET_PDEATHSIG, PR_SET_DUMPABLE, PR_CAPBSET_DROP, PR_SET_SECUREBITS = 1, 4, 24, 28
PR_SET_CHILD_SUBREAPER, PR_SET_NO_NEW_PRIVS = 36, 38
PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL = 47, 4
SIOCSIFFLAGS, IFF_UP, IFF_RUNNING = 0x8914, 0x1, 0x40
#: The number of pivot_root, which the C library lacks; that of mount_setattr is the same anywhere.
_PIVOT_ROOT = {"x86_64": 155, "aarch64": 41}
_MOUNT_SETATTR = 442
_CAPABILITY_VERSION = 0x20080522

_libc: Any = ctypes.CDLL(None, use_errno=True)


def call(function: str, *arguments: object) -> None:
    """Call a function of C's that tells failure by its value, and the reason by errno.

    Raises:
        OSError: the system does not allow it, or does not know it; its `filename` is the function.
    """
    there = getattr(_libc, function, None)
    if there is None:
        raise OSError(errno.ENOSYS, "there is none here", function)
    if there(*arguments) != 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number), function)


def unshare(kinds: int) -> None:
    """Leave the namespaces that the calling thread shares with others.

    Raises:
        OSError: the system does not allow it; its `filename` names the kinds: "unshare (net)".
    """
    try:
        call("unshare", kinds)
    except OSError as error:
        names = ", ".join(name for kind, name in KINDS.items() if kinds & kind)
        raise OSError(error.errno, error.strerror, f"unshare ({names})") from None


def enter(namespace: int, kind: int) -> None:
    """Move the calling thread into a namespace, given as an open descriptor.

    Raises:
        OSError: the system does not allow it.
    """
    call("setns", namespace, kind)


def mount(kind: str, target: str, flags: int, data: str = "", source: str = "none") -> None:
    """Mount a file system that needs no device; or, with MS_BIND, a folder or file again.

    Raises:
        OSError: the system does not allow it.
    """
    words = (os.fsencode(source), os.fsencode(target), kind.encode())
    call("mount", *words, ctypes.c_ulong(flags), data.encode())


def change_mount(target: str, put: int, take: int = 0, *, below: bool = False) -> None:
    """Put attributes on a mount and take some away; `below`: on those below it as well.

    Raises:
        OSError: the system does not allow it, or is older than Linux 5.12.
    """
    attributes = (ctypes.c_uint64 * 4)(put, take, 0, 0)
    words = (os.fsencode(target), ctypes.c_uint(AT_RECURSIVE if below else 0))
    number, size = ctypes.c_long(_MOUNT_SETATTR), ctypes.c_size_t(ctypes.sizeof(attributes))
    call("syscall", number, ctypes.c_int(AT_FDCWD), *words, attributes, size)


def change_root() -> None:
    """Make the current folder, a mount, the root of all; what was the root is there no more.

    Raises:
        OSError: the system does not allow it.
    """
    number = _PIVOT_ROOT.get(os.uname().machine)
    if number is None:
        raise OSError(errno.ENOSYS, f"no pivot_root known for {os.uname().machine}")
    call("syscall", ctypes.c_long(number), b".", b".")
    call("umount2", b".", ctypes.c_int(MNT_DETACH))
    os.chdir("/")


def control(option: int, *values: int) -> bool:
    """As prctl; whether it was done."""
    words = [ctypes.c_ulong(value) for value in (*values, 0, 0, 0, 0)[:4]]
    there = getattr(_libc, "prctl", None)
    return there is not None and bool(there(option, *words) == 0)


def signal_at_parents_death(number: int) -> None:
    """Have the kernel send us a signal when our parent dies."""
    control(PR_SET_PDEATHSIG, number)


def set_capabilities(permitted: int = 0) -> None:
    """Have these capabilities, a set of bits, and no others; none of them is inherited.

    Raises:
        OSError: the system does not allow it.
    """
    low, high = permitted & 0xFFFFFFFF, permitted >> 32
    header = (ctypes.c_uint32 * 2)(_CAPABILITY_VERSION, 0)
    call("capset", header, (ctypes.c_uint32 * 6)(low, low, 0, high, high, 0))


def raise_loopback() -> None:
    """Bring up the loopback device of the calling thread's network namespace.

    Raises:
        OSError: the system does not allow it.
    """
    import fcntl  # here, because a submission's process has no need of them and is to start soon
    import socket
    import struct

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        fcntl.ioctl(any_socket, SIOCSIFFLAGS, struct.pack("16sh14x", b"lo", IFF_UP | IFF_RUNNING))
