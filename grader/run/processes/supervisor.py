"""Starts a submission's process, keeps hold of all its descendants, and tells how it ended.

    python -I -S supervisor.py run PARENT_PID REPORT_FD ORDER_FD COMMAND...
    python -I -S supervisor.py hold

`run` writes two lines to REPORT_FD: the process id of the command, and, when it has ended, its exit
code (negative for a signal), or `refused` and why it was not started (`refusal.py`). How it is to
be confined (`sandbox/confinement.py`) is read from ORDER_FD, as JSON. The descendants may go on
until SIGTERM comes, or the parent dies: the grader, or the zygote that has forked instead of
starting this script (`forking.py`).
Where the system allows it the command gets a process namespace of its own, so that it can neither
see nor kill the simulator; else the supervisor adopts what its family leaves behind.

`hold` makes a network namespace inside a user namespace, says `ready` (or `refused` and why), and
keeps both until its standard input closes.

A script of its own, with nothing but the standard library and little of ours: it starts in a few
milliseconds.
"""

# ruff: noqa: PTH123, PTH208
# Importing pathlib would take longer than all the rest.

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress
from typing import Any, NoReturn

if __name__ == "__main__":
    # on the import path, which is empty but for Python's own: where our packages are
    sys.path.append(os.path.realpath(f"{__file__}/../../../.."))

from grader.run.processes import linux
from grader.run.processes.refusal import Refusal
from grader.run.processes.sandbox import confinement

#: Stands before the reason why a command was not started.
REFUSED = "refused"
#: Signals that are meant for the command, and reach us only because we are in its group.
NOT_OURS = [signal.SIGINT, signal.SIGHUP, signal.SIGQUIT]


def confine(order: dict[str, Any] | None, lacking: OSError | None) -> None:
    """What confines a submission's own process, and nothing else of its run.

    The one place for a sandbox, however the process came to be: it is called in it, after its
    supervisor has forked and before anything of the submission's runs. Descriptors, network,
    environment and current folder are settled by then; what is done here survives an exec.

    Args:
        order: see `.sandbox.confinement`; None: nothing is confined but what is seen of processes.
        lacking: why there is no process namespace for it; None where there is one.

    Raises:
        OSError: it cannot be confined as ordered.
    """
    level = None if order is None else order["level"]
    if level == confinement.NAMESPACES and lacking is not None:
        raise lacking
    if lacking is None and level != confinement.NAMESPACES:
        _see_only_own_processes()
    if order is not None:
        confinement.confine(order)


class Supervisor:
    """Between the grader and a submission's process."""

    def __init__(self, parent: int, report: int, order: dict[str, Any] | None) -> None:
        self._parent = parent
        self._report = report
        self._order = order
        self._refusal, self._refuses = os.pipe()
        self._init = 0  # the first process of the namespace, whose end is the end of all in it
        self._lacking: OSError | None = None

    def run(self, command: list[str] | None) -> None:
        """Run the command; ends when the grader has had enough.

        Without a command it returns, once and in a process of its own: that goes on as the command.
        """
        signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGTERM, signal.SIGCHLD])
        linux.signal_at_parents_death(signal.SIGTERM)
        if os.getppid() != self._parent:
            os._exit(1)  # it has died before we asked
        for number in NOT_OURS:
            signal.signal(number, signal.SIG_IGN)
        # A SIGCHLD that nobody handles would not wake sigwait below.
        signal.signal(signal.SIGCHLD, lambda *_: None)
        linux.control(linux.PR_SET_CHILD_SUBREAPER, 1)
        try:
            linux.unshare(linux.CLONE_NEWPID | linux.CLONE_NEWIPC)
            self._init = os.fork() or self._be_init()
        except OSError as error:
            self._lacking = error
        child = os.fork()
        if not child:
            self._be_command(command)
            return
        linux.control(linux.PR_SET_DUMPABLE, 0)  # no other process of this user looks into us
        # The command's sockets are closed when it closes them, not when we do.
        for fd in os.listdir("/proc/self/fd"):
            if int(fd) > 2 and int(fd) not in (self._report, self._refusal):
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
                    word = self._why_refused() or os.waitstatus_to_exitcode(ended[1])
                    with suppress(BrokenPipeError):
                        os.write(self._report, f"{word}\n".encode())

    def _why_refused(self) -> str:
        """Why the command was not started; '' if it was."""
        why = os.read(self._refusal, 2000).decode("utf-8", "replace")
        return f"{REFUSED} {' '.join(why.split())}" if why else ""

    def _end_all(self) -> None:
        """Kill every descendant, however it has hidden from its parent."""
        if self._init:
            with suppress(ProcessLookupError):
                os.kill(self._init, signal.SIGKILL)
        # A look misses who is born, or changes parents, in the middle of it. But whose parent has
        # gone becomes our child: none are left only when we have no child any more.
        while True:
            for pid in _descendants(os.getpid()):
                with suppress(ProcessLookupError):
                    # its group at once: who forks and ends all the time is never there to be killed
                    if (group := os.getpgid(pid)) != os.getpgrp():
                        os.killpg(group, signal.SIGKILL)
                    os.kill(pid, signal.SIGKILL)
            try:
                while os.waitpid(-1, os.WNOHANG)[0]:
                    pass
            except ChildProcessError:
                return

    def _be_init(self) -> NoReturn:
        """Adopt and forget orphans, to the end."""
        signal.pthread_sigmask(signal.SIG_SETMASK, [])
        linux.signal_at_parents_death(signal.SIGKILL)
        signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits, so the kernel reaps
        os.closerange(0, 1 << 16)
        linux.control(linux.PR_SET_DUMPABLE, 0)
        while True:
            signal.pause()

    def _be_command(self, command: list[str] | None) -> None:
        try:
            # what it sends to its group does not reach us, wherever we are
            os.setsid()
            linux.signal_at_parents_death(signal.SIGKILL)
            os.close(self._refusal)
            confine(self._order, self._lacking)
            os.close(self._report)
            _reset_signals()
            if command is not None:
                os.execvp(command[0], command)
            # as Python does where it starts
            signal.signal(signal.SIGINT, signal.default_int_handler)
            signal.signal(signal.SIGPIPE, signal.SIG_IGN)
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            os.close(self._refuses)
        except BaseException as error:
            os.write(self._refuses, Refusal.of(error).to_line().encode("utf-8", "replace")[:1000])
            os._exit(127)


def _reset_signals() -> None:
    for number in signal.valid_signals() - {signal.SIGKILL, signal.SIGSTOP}:
        with suppress(OSError):  # the C library's own
            signal.signal(number, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_SETMASK, [])


def _see_only_own_processes() -> None:
    """Show the processes of our namespace in /proc; what it leaves in shared memory goes with it.

    Where this is refused, the others are seen, but still out of reach of signals.
    """
    with suppress(OSError):
        linux.unshare(linux.CLONE_NEWNS)
        linux.mount("", "/", linux.MS_REC | linux.MS_PRIVATE)
        linux.mount("proc", "/proc", linux.MS_NOSUID | linux.MS_NODEV | linux.MS_NOEXEC)
        linux.mount("tmpfs", "/dev/shm", linux.MS_NOSUID | linux.MS_NODEV, "size=64m,mode=1777")


def _descendants(ancestor: int) -> list[int]:
    """All processes below one, in a /proc that shows us; a zombie's threads may go on."""
    parents: dict[int, int] = {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        with suppress(OSError, ValueError), open(f"/proc/{name}/stat", "rb") as file:
            parents[int(name)] = int(file.read().rpartition(b")")[2].split()[1])
    found = {ancestor}
    while more := {pid for pid, parent in parents.items() if parent in found} - found:
        found |= more
    return sorted(found - {ancestor})


def hold() -> None:
    """Make the namespaces and keep them until standard input closes."""
    user, group = os.getuid(), os.getgid()
    try:
        linux.unshare(linux.CLONE_NEWUSER | linux.CLONE_NEWNET)
        for name, text in (
            ("setgroups", "deny"),
            ("uid_map", f"0 {user} 1"),
            ("gid_map", f"0 {group} 1"),
        ):
            with open(f"/proc/self/{name}", "w", encoding="ascii") as file:
                file.write(text)
        linux.raise_loopback()
    except OSError as error:
        os.write(1, f"{REFUSED} {Refusal.of(error).to_line()}\n".encode("utf-8", "replace"))
        return
    os.write(1, b"ready\n")
    os.read(0, 1)


def main() -> None:
    """Do what the command line says."""
    if sys.argv[1] == "hold":
        hold()
        return
    parent, report, order, *command = sys.argv[2:]
    Supervisor(int(parent), int(report), _read_order(int(order))).run(command)


def _read_order(file: int) -> dict[str, Any] | None:
    import json  # here: a zygote's child has it already

    with open(file, "rb") as opened:
        opened.seek(0)
        order: dict[str, Any] | None = json.load(opened)
    return order


if __name__ == "__main__":
    main()
