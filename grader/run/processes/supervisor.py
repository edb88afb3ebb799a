"""The supervisor above a submission's process: holds its descendants, and reports how it ended.

The report is that of `fork_server_main`. The descendants may run until the supervisor gets SIGTERM,
or its fork server dies. Where the system allows it the command gets a process namespace of its own,
so that it can neither see nor kill the simulator; else the supervisor adopts its orphans. Two or
three processes are forked:

    fork server -> supervisor -> first process of the namespace, if there is one
                              -> the submission's
"""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Mapping
from contextlib import suppress
from typing import Any, NoReturn

from grader.run.sandbox import confinement
from grader.system import linux

#: Signals for the command, which reach the supervisor only because it is in the same group.
NOT_OURS = [signal.SIGINT, signal.SIGHUP, signal.SIGQUIT]
#: The options of its shared memory: as much as `grader.run.limits.SCRATCH` has.
SHARED_MEMORY = "size=64m,mode=1777"


def report_fact(report: int, **fact: object) -> None:
    """Write a line to a report, whose reader may be gone."""
    with suppress(BrokenPipeError):
        os.write(report, json.dumps(fact).encode() + b"\n")


def confine(order: Mapping[str, Any] | None, refused: OSError | None) -> None:
    """Confine a submission's process, and nothing else of its run.

    Called in that process, after its supervisor has forked and before any code of the submission
    runs. Descriptors, network, environment and current folder are set by then; the confinement
    survives an exec.

    Args:
        order: see `grader.run.sandbox.confinement`; None: only other processes are hidden.
        refused: why there is no process namespace for it; None where there is one.
    """
    level = None if order is None else order["level"]
    if level == confinement.NAMESPACES and refused is not None:
        raise refused
    if refused is None and level != confinement.NAMESPACES:
        _hide_other_processes()
    if order is not None:
        confinement.confine(order)


def fork_below(parent: int, report: int) -> OSError | None:
    """Become a supervisor, and fork the process that it stands above.

    The supervisor never returns: it ends in here, at the grader's signal.

    Args:
        parent: the process id of the fork server.

    Returns:
        In the process below it: why there is no process namespace for that; None where there is.
    """
    signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGTERM, signal.SIGCHLD])
    linux.go_with_parent(parent, signal.SIGTERM)
    for number in NOT_OURS:
        signal.signal(number, signal.SIG_IGN)
    # A SIGCHLD that nobody handles would not wake sigwait below.
    signal.signal(signal.SIGCHLD, lambda *_: None)
    linux.control(linux.PR_SET_CHILD_SUBREAPER, 1)
    first, refused = 0, None
    try:
        linux.unshare(linux.CLONE_NEWPID | linux.CLONE_NEWIPC)
        first = os.fork()
    except OSError as error:
        refused = error
    else:
        if not first:
            _be_first_process()
    child = os.fork()
    if child:
        _supervise(child, first, report)
    # a signal to its group does not reach the supervisor
    os.setsid()
    linux.signal_at_parents_death(signal.SIGKILL)
    return refused


def _supervise(child: int, first: int, report: int) -> NoReturn:
    linux.control(linux.PR_SET_DUMPABLE, 0)  # no other process of this user reads our memory
    # The command's sockets are closed when it closes them, not when we do.
    linux.close_descriptors((0, 1, 2, report))
    report_fact(report, pid=child)
    while signal.sigwait([signal.SIGTERM, signal.SIGCHLD]) != signal.SIGTERM:
        with suppress(ChildProcessError):
            while (ended := os.waitpid(-1, os.WNOHANG))[0]:
                if ended[0] == child:
                    report_fact(report, exit=os.waitstatus_to_exitcode(ended[1]))
    if first:  # its end is that of all in its namespace
        with suppress(ProcessLookupError):
            os.kill(first, signal.SIGKILL)
    end_descendants()
    os._exit(0)


def end_descendants() -> None:
    """Kill every descendant of this process, however it has hidden from its parent.

    A scan of /proc misses a process that is forked, or changes parents, meanwhile. But an orphan
    becomes our child: none are left when we have no child any more.
    """
    while True:
        for pid in linux.descendants(os.getpid()):
            with suppress(ProcessLookupError):
                # its group at once: one that forks and ends all the time is never found alive
                if (group := os.getpgid(pid)) != os.getpgrp():
                    os.killpg(group, signal.SIGKILL)
                os.kill(pid, signal.SIGKILL)
        try:
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass
        except ChildProcessError:
            return


def _be_first_process() -> NoReturn:
    """Be the first process of a namespace: adopt its orphans, and reap them."""
    signal.pthread_sigmask(signal.SIG_SETMASK, [])
    linux.signal_at_parents_death(signal.SIGKILL)
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits, so the kernel reaps
    os.closerange(0, 1 << 16)
    linux.control(linux.PR_SET_DUMPABLE, 0)
    while True:
        signal.pause()


def _hide_other_processes() -> None:
    """Show only this namespace's processes in /proc, and give it a separate shared memory.

    Where this is refused, the others are visible, but still out of reach of signals.
    """
    with suppress(OSError):
        linux.unshare(linux.CLONE_NEWNS)
        linux.mount("", "/", linux.MS_REC | linux.MS_PRIVATE)
        linux.mount("proc", "/proc", linux.MS_NOSUID | linux.MS_NODEV | linux.MS_NOEXEC)
        linux.mount("tmpfs", "/dev/shm", linux.MS_NOSUID | linux.MS_NODEV, SHARED_MEMORY)
