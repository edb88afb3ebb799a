"""Stands above a submission's process, keeps hold of all its descendants, and tells how it ended.

It writes to the report of its process (`forking`). The descendants may go on until SIGTERM comes,
or the fork server dies that it comes from. Where the system allows it the command gets a process
namespace of its own, so that it can neither see nor kill the simulator; else the supervisor adopts
what its family leaves behind.
"""

# ruff: noqa: PTH208
# Importing pathlib would take longer than all the rest.

from __future__ import annotations

import json
import os
import signal
from contextlib import suppress
from typing import Any, NoReturn

from grader import linux, usage
from grader.run.processes.sandbox import confinement

#: Signals that are meant for the command, and reach us only because we are in its group.
NOT_OURS = [signal.SIGINT, signal.SIGHUP, signal.SIGQUIT]


def tell(report: int, **fact: object) -> None:
    """Write a line to a report; whoever listens to it may have gone."""
    with suppress(BrokenPipeError):
        os.write(report, json.dumps(fact).encode() + b"\n")


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

    def __init__(self, parent: int, report: int) -> None:
        self._parent = parent
        self._report = report
        self._init = 0  # the first process of the namespace, whose end is the end of all in it

    def run(self) -> OSError | None:
        """Supervise a fork of this process; ends when the grader has had enough.

        Returns once, in the fork: why there is no process namespace for it; None where there is
        one.
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
        lacking = None
        try:
            linux.unshare(linux.CLONE_NEWPID | linux.CLONE_NEWIPC)
            self._init = os.fork() or self._be_init()
        except OSError as error:
            lacking = error
        child = os.fork()
        if not child:
            # what it sends to its group does not reach us, wherever we are
            os.setsid()
            linux.signal_at_parents_death(signal.SIGKILL)
            return lacking
        linux.control(linux.PR_SET_DUMPABLE, 0)  # no other process of this user looks into us
        # The command's sockets are closed when it closes them, not when we do.
        for fd in os.listdir("/proc/self/fd"):
            if int(fd) > 2 and int(fd) != self._report:
                with suppress(OSError):
                    os.close(int(fd))
        tell(self._report, pid=child)
        while signal.sigwait([signal.SIGTERM, signal.SIGCHLD]) != signal.SIGTERM:
            self._reap(child)
        self._end_all()
        os._exit(0)

    def _reap(self, child: int) -> None:
        with suppress(ChildProcessError):
            while (ended := os.waitpid(-1, os.WNOHANG))[0]:
                if ended[0] == child:
                    tell(self._report, exit=os.waitstatus_to_exitcode(ended[1]))

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
    names = filter(str.isdigit, os.listdir("/proc"))
    parents = {int(name): usage.look(int(name)).parent for name in names}
    found = {ancestor}
    while more := {pid for pid, parent in parents.items() if parent in found} - found:
        found |= more
    return sorted(found - {ancestor})
