"""Starts a submission's process, keeps hold of all its descendants, and tells how it ended.

    python -I -S supervisor.py run PARENT_PID REPORT_FD COMMAND...
    python -I -S supervisor.py hold

`run` writes two lines to REPORT_FD: the process id of the command, and, when it has ended, its exit
code (negative for a signal). The descendants may go on until SIGTERM comes, or the parent dies: the
grader, or the zygote that has forked instead of starting this script (`forking.py`).
Where the system allows it the command gets a process namespace of its own, so that it can neither
see nor kill the simulator; else the supervisor adopts what its family leaves behind.

`hold` makes a network namespace inside a user namespace, says `ready`, and keeps both until its
standard input closes.

A script of its own, with nothing but the standard library: it starts in a few milliseconds.
"""

# ruff: noqa: PTH123, PTH208
# Importing pathlib would take longer than all the rest.

from __future__ import annotations

import ctypes
import errno
import os
import signal
import sys
from contextlib import suppress
from typing import Any, NoReturn

CLONE_NEWNS, CLONE_NEWIPC, CLONE_NEWUSER = 0x00020000, 0x08000000, 0x10000000
CLONE_NEWPID, CLONE_NEWNET = 0x20000000, 0x40000000
MS_NOSUID, MS_NODEV, MS_NOEXEC, MS_REC, MS_PRIVATE = 2, 4, 8, 0x4000, 0x40000
PR_SET_PDEATHSIG, PR_SET_CHILD_SUBREAPER = 1, 36
SIOCSIFFLAGS, IFF_UP, IFF_RUNNING = 0x8914, 0x1, 0x40
#: Signals that are meant for the command, and reach us only because we are in its group.
NOT_OURS = [
    getattr(signal, name) for name in ("SIGINT", "SIGHUP", "SIGQUIT") if hasattr(signal, name)
]

# Other systems than Linux may import this, but have no use for it: Windows has no libc.
_libc: Any = ctypes.CDLL(None, use_errno=True) if os.name == "posix" else None


def _call(function: str, *arguments: object) -> None:
    there = getattr(_libc, function, None)
    if there is None:
        raise OSError(errno.ENOSYS, f"no {function} here")
    if there(*arguments) != 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))


def unshare(kinds: int) -> None:
    """Leave the namespaces that the calling thread shares with others.

    Raises:
        OSError: the system does not allow it.
    """
    _call("unshare", kinds)


def mount(kind: str, target: str, flags: int, data: str = "") -> None:
    """Mount a file system that needs no device.

    Raises:
        OSError: the system does not allow it.
    """
    words = (b"none", target.encode(), kind.encode(), ctypes.c_ulong(flags), data.encode())
    _call("mount", *words)


def raise_loopback() -> None:
    """Bring up the loopback device of the calling thread's network namespace.

    Raises:
        OSError: the system does not allow it.
    """
    import fcntl  # here, because `run` has no need of them and is to start soon
    import socket
    import struct

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        fcntl.ioctl(any_socket, SIOCSIFFLAGS, struct.pack("16sh14x", b"lo", IFF_UP | IFF_RUNNING))


def enter(namespace: int, kind: int) -> None:
    """Move the calling thread into a namespace, given as an open descriptor.

    Raises:
        OSError: the system does not allow it.
    """
    _call("setns", namespace, kind)


def control(option: int, value: int) -> None:
    """As prctl; what the system does not know is left out."""
    _libc.prctl(option, ctypes.c_ulong(value), ctypes.c_ulong(0), ctypes.c_ulong(0))


def signal_at_parents_death(number: int) -> None:
    """Have the kernel send us a signal when our parent dies."""
    _libc.prctl(PR_SET_PDEATHSIG, number)


def confine(*, has_namespace: bool) -> None:
    """What confines a submission's own process, and nothing else of its run.

    The one place for a sandbox (Landlock, seccomp, further mounts), however the process came to be:
    it is called in it, after its supervisor has forked and before anything of the submission's
    runs. Descriptors, network, environment and current folder are settled by then; what is done
    here survives an exec.
    """
    if has_namespace:
        _see_only_own_processes()


class Supervisor:
    """Between the grader and a submission's process."""

    def __init__(self, parent: int, report: int) -> None:
        self._parent = parent
        self._report = report
        self._init = 0  # the first process of the namespace, whose end is the end of all in it

    def run(self, command: list[str] | None) -> None:
        """Run the command; ends when the grader has had enough.

        Without a command it returns, once and in a process of its own: that goes on as the command.
        """
        signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGTERM, signal.SIGCHLD])
        signal_at_parents_death(signal.SIGTERM)
        if os.getppid() != self._parent:
            os._exit(1)  # it has died before we asked
        for number in NOT_OURS:
            signal.signal(number, signal.SIG_IGN)
        # A SIGCHLD that nobody handles would not wake sigwait below.
        signal.signal(signal.SIGCHLD, lambda *_: None)
        _libc.prctl(PR_SET_CHILD_SUBREAPER, 1)
        with suppress(OSError):
            unshare(CLONE_NEWPID | CLONE_NEWIPC)
            self._init = os.fork() or self._be_init()
        child = os.fork()
        if not child:
            self._be_command(command)
            return
        # The command's sockets are closed when it closes them, not when we do.
        for fd in os.listdir("/proc/self/fd"):
            if int(fd) > 2 and int(fd) != self._report:
                with suppress(OSError):
                    os.close(int(fd))
        os.write(self._report, f"{child}\n".encode())
        while signal.sigwait([signal.SIGTERM, signal.SIGCHLD]) != signal.SIGTERM:
            self._reap(child)
        self._end_all()
        self._reap(child)
        os._exit(0)

    def _reap(self, child: int) -> None:
        with suppress(ChildProcessError):
            while (ended := os.waitpid(-1, os.WNOHANG))[0]:
                if ended[0] == child:
                    code = os.waitstatus_to_exitcode(ended[1])
                    with suppress(BrokenPipeError):
                        os.write(self._report, f"{code}\n".encode())

    def _end_all(self) -> None:
        """Kill every descendant, however it has hidden from its parent."""
        if self._init:
            with suppress(ProcessLookupError):
                os.kill(self._init, signal.SIGKILL)
        me = os.getpid()
        while family := _descendants(me):
            for pid in family:
                with suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
            with suppress(ChildProcessError):
                while os.waitpid(-1, os.WNOHANG)[0]:
                    pass

    def _be_init(self) -> NoReturn:
        """Adopt and forget orphans, to the end."""
        signal.pthread_sigmask(signal.SIG_SETMASK, [])
        signal_at_parents_death(signal.SIGKILL)
        signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits, so the kernel reaps
        os.closerange(0, 1 << 16)
        while True:
            signal.pause()

    def _be_command(self, command: list[str] | None) -> None:
        try:
            signal_at_parents_death(signal.SIGKILL)
            confine(has_namespace=bool(self._init))
            os.close(self._report)
            for number in (*NOT_OURS, signal.SIGCHLD):
                signal.signal(number, signal.SIG_DFL)
            if command is None:  # as Python does where it starts
                signal.signal(signal.SIGINT, signal.default_int_handler)
            signal.pthread_sigmask(signal.SIG_SETMASK, [])
            if command is not None:
                os.execvp(command[0], command)
        except BaseException:
            os._exit(127)


def _see_only_own_processes() -> None:
    """Show the processes of our namespace in /proc; what it leaves in shared memory goes with it.

    Where this is refused, the others are seen, but still out of reach of signals.
    """
    with suppress(OSError):
        unshare(CLONE_NEWNS)
        mount("", "/", MS_REC | MS_PRIVATE)
        mount("proc", "/proc", MS_NOSUID | MS_NODEV | MS_NOEXEC)
        mount("tmpfs", "/dev/shm", MS_NOSUID | MS_NODEV, "size=64m,mode=1777")


def _descendants(ancestor: int) -> list[int]:
    """All living processes below one, in a /proc that shows us."""
    parents: dict[int, int] = {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        with suppress(OSError, ValueError), open(f"/proc/{name}/stat", "rb") as file:
            state, parent = file.read().rpartition(b")")[2].split()[:2]
            if state not in (b"Z", b"X"):
                parents[int(name)] = int(parent)
    found = {ancestor}
    while more := {pid for pid, parent in parents.items() if parent in found} - found:
        found |= more
    return sorted(found - {ancestor})


def hold() -> None:
    """Make the namespaces and keep them until standard input closes."""
    user, group = os.getuid(), os.getgid()
    unshare(CLONE_NEWUSER | CLONE_NEWNET)
    for name, text in (
        ("setgroups", "deny"),
        ("uid_map", f"0 {user} 1"),
        ("gid_map", f"0 {group} 1"),
    ):
        with open(f"/proc/self/{name}", "w", encoding="ascii") as file:
            file.write(text)
    raise_loopback()
    os.write(1, b"ready\n")
    os.read(0, 1)


def main() -> None:
    """Do what the command line says."""
    if sys.argv[1] == "hold":
        hold()
        return
    parent, report, *command = sys.argv[2:]
    Supervisor(int(parent), int(report)).run(command)


if __name__ == "__main__":
    main()
