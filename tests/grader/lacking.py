"""Runs Python as on a system that is not Linux: what that system lacks is taken away first.

    python lacking.py SYSTEM PYTHON ...

SYSTEM is `macos` or `windows`; PYTHON is what stands in for the interpreter, a command that comes
here again, so that the processes that we start lack the same; `...` is what the interpreter would
be told: `-m module ...`, `-c code ...` or `script.py ...`. Really taken away is what our code asks
for; the rest of Python goes on as on Linux.
"""

import builtins
import ctypes
import os
import runpy
import signal
import socket
import sys
import types
from pathlib import Path
from typing import Any

#: Only Linux has these.
OF_LINUX = (
    *("memfd_create", "eventfd", "eventfd_read", "eventfd_write", "pidfd_open", "setns", "unshare"),
    *("sched_getaffinity", "sched_setaffinity"),
)
OF_LINUX_S_LIBC = {"prctl", "unshare", "mount", "setns", "eventfd_write"}
#: Windows lacks these as well.
OF_POSIX = ("getuid", "getgid", "killpg", "getpgrp", "tcgetpgrp", "setsid", "getppid", "forkpty")
MODULES_OF_POSIX = {"fcntl", "termios", "resource", "pty", "tty", "_posixsubprocess"}
#: ... but for SIGKILL, which psutil and subprocess want here.
SIGNALS_OF_POSIX = ("SIGHUP", "SIGQUIT", "SIGTSTP", "SIGCONT")


class Libc:
    """A C library without what only Linux's has."""

    def __init__(self, libc: Any) -> None:
        self._libc = libc

    def __getattr__(self, name: str) -> Any:
        if name in OF_LINUX_S_LIBC:
            raise AttributeError(name)
        return getattr(self._libc, name)


def like_macos() -> None:
    """No Linux: no /proc, no namespaces, nothing that only its kernel does."""
    for name in OF_LINUX:
        vars(os).pop(name, None)
    original, pair = ctypes.CDLL, socket.socketpair

    def load(name: str | None, *args: Any, **more: Any) -> Any:
        found = original(name, *args, **more)
        return Libc(found) if name is None else found

    def connected(family: int = socket.AF_UNIX, kind: int = socket.SOCK_STREAM, *more: int) -> Any:
        if kind == socket.SOCK_SEQPACKET:
            raise OSError("protocol not supported")
        return pair(family, kind, *more)

    ctypes.CDLL = load  # type: ignore[assignment,misc]
    socket.socketpair = connected  # type: ignore[assignment]


def like_windows() -> None:
    """No POSIX either."""
    like_macos()
    import fcntl
    import subprocess  # while there is what it is made of

    def lock(file: int, mode: int, count: int) -> None:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)

    sys.modules["msvcrt"] = types.ModuleType("msvcrt")
    vars(sys.modules["msvcrt"]).update(locking=lock, LK_NBLCK=2)
    original, start = builtins.__import__, subprocess.Popen.__init__

    def load(name: str, *args: Any, **more: Any) -> Any:
        # what Python and its packages ask for at home is theirs
        asks = (args[0] if args else more.get("globals") or {}).get("__name__", "")
        if name in MODULES_OF_POSIX and asks.startswith(("grader", "turtlesim")):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        return original(name, *args, **more)

    def start_without(self: Any, *args: Any, **more: Any) -> None:
        assert not more.get("pass_fds"), "a process is given nothing on Windows"
        start(self, *args, **more)

    builtins.__import__ = load
    subprocess.Popen.__init__ = start_without  # type: ignore[assignment,method-assign]
    for name in OF_POSIX:
        vars(os).pop(name, None)
    for name in SIGNALS_OF_POSIX:
        vars(signal).pop(name, None)


def hide() -> None:
    """Take away from our own code what the one module that asks for it knows."""
    from grader.system import versions as ours

    ours.PROC = Path("/nowhere")


def main(system: str, python: str, *words: str) -> None:
    """Run what the interpreter was told."""
    sys.executable = python
    {"macos": like_macos, "windows": like_windows}[system]()
    kind, *rest = (word for word in words if word not in ("-I", "-S"))
    if not kind.endswith("main.py"):  # a submission's process, into which nothing of ours goes
        sys.path[0] = str(Path(__file__).parents[2])
        hide()
    if kind == "-m":
        sys.argv = rest
        runpy.run_module(rest[0], run_name="__main__", alter_sys=True)
    elif kind == "-c":
        sys.argv = ["-c", *rest[1:]]
        exec(compile(rest[0], "<string>", "exec"), {"__name__": "__main__"})
    else:
        sys.argv = list(words)
        sys.path[0] = str(Path(kind).parent)
        runpy.run_path(kind, run_name="__main__")


if __name__ == "__main__":
    main(*sys.argv[1:])
