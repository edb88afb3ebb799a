"""What this system has of what a run likes to have: Linux has all of it, others do not.

Nothing here is remembered, so that tests can take things away. Who uses a thing says what he does
without it:

| what | without it |
|---|---|
| `has_memfd` | the recording is a file of the run's folder, without a name where that can be |
| `inherits_descriptors` | the simulator calls back over loopback; the recording has a name |
| `has_supervision` | a submission is a group of processes (Windows: a tree), ended as such |
| `has_proc` | processes are looked at through psutil |
| `has_pidfd` | no zygote: each process of a run starts from nothing |
| `has_limited_copies` | checks run in the grader's process, without limits |
| `lacks_for_lockstep` | virtual time says what it lacks, and the run goes to real time |
"""

from __future__ import annotations

import ctypes
import os
import signal
import socket
import sys
from pathlib import Path

#: Where Linux shows its processes.
PROC = Path("/proc")


def is_ros_sourced() -> bool:
    """Whether ROS comes from the user's shell rather than from PyPI."""
    return "ROS_DISTRO" in os.environ


def has_proc() -> bool:
    """Whether processes and their descriptors are shown as files, as Linux does."""
    return (PROC / "self" / "stat").exists()


def has_memfd() -> bool:
    """Whether there can be a file that no folder holds."""
    return hasattr(os, "memfd_create")


def inherits_descriptors() -> bool:
    """Whether a process that we start can be given open files and sockets."""
    return os.name == "posix"


def has_supervision() -> bool:
    """Whether a process can adopt all its descendants, and find them: Linux only."""
    return is_in_libc("prctl") and has_proc()


def is_in_libc(function: str) -> bool:
    """Whether C has a function of this name here."""
    try:
        return hasattr(ctypes.CDLL(None), function)
    except (OSError, TypeError):  # Windows has no libc to ask
        return False


def has_pidfd() -> bool:
    """Whether there are descriptors that stand for processes."""
    if not (hasattr(os, "pidfd_open") and hasattr(signal, "pidfd_send_signal")):
        return False
    try:
        os.close(os.pidfd_open(os.getpid()))
    except OSError:  # an old kernel, or one that is not to
        return False
    return True


def has_limited_copies() -> bool:
    """Whether a fork of this process is a process like any other, and can be limited.

    Not on macOS, whose libraries do not survive it.
    """
    return hasattr(os, "fork") and sys.platform == "linux" and has_proc()


def lacks_for_lockstep() -> list[str]:
    """What virtual time needs and this system lacks."""
    needed = {
        "SOCK_SEQPACKET": hasattr(socket, "AF_UNIX") and hasattr(socket, "SOCK_SEQPACKET"),
        "/proc": has_proc(),
        "inherited descriptors": inherits_descriptors(),
    }
    return [name for name, is_there in needed.items() if not is_there]


def user() -> str:
    """What tells this user's files from those of others."""
    return str(os.getuid()) if hasattr(os, "getuid") else os.environ.get("USERNAME", "user")


def is_own(found: os.stat_result) -> bool:
    """Whether a file is this user's; Windows keeps such things in lists that are not looked at."""
    return not hasattr(os, "geteuid") or found.st_uid == os.geteuid()


def owner(found: os.stat_result) -> str:
    """Whose a file is, for a message: a name, or else a number."""
    try:
        import pwd  # here, since Windows lacks it

        return pwd.getpwuid(found.st_uid).pw_name
    except (ImportError, KeyError):
        return f"user {found.st_uid}"


def descriptor_path(descriptor: int) -> str:
    """What opens, in a process that has inherited it, the file behind a descriptor."""
    folder = PROC / "self" / "fd" if has_proc() else Path("/dev/fd")
    return str(folder / str(descriptor))
