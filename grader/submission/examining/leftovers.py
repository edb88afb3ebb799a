"""What a step leaves running when it is over: ended, before the next one begins.

A stranger's set-up may start programs that outlive it, or one that starts others without end. Their
parents gone, they become children of the process that looks (`adopt`), which ends them all.
"""

from __future__ import annotations

import os
import signal
import time
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import Final

from grader.system import linux

_PROC: Final = Path("/proc")
#: After so many looks, each of which stops those who were born meanwhile, all are ended at once.
_MOST_LOOKS: Final = 200
_adopts = False


def adopt() -> None:
    """From now on whatever this process starts stays below it, and `end` ends it."""
    global _adopts
    _adopts = linux.control(linux.PR_SET_CHILD_SUBREAPER, 1)


def end() -> None:
    """End all that is below this process, if it has adopted it.

    Only the kernel knows when nothing is left: a look at /proc misses who was born during it while
    its parent ended.
    """
    if not _adopts:
        return
    stopped: set[int] = set()
    with suppress(ChildProcessError):  # nothing is left
        for look in count():
            found = set(linux.descendants(os.getpid())) if _is_seen() else _children()
            if found <= stopped or look > _MOST_LOOKS:
                _signal(found, signal.SIGKILL)
                while os.waitpid(-1, os.WNOHANG)[0]:
                    pass
                time.sleep(0.001)
            else:  # who is stopped has no more children
                _signal(found - stopped, signal.SIGSTOP)
                stopped |= found


def _signal(processes: set[int], what: signal.Signals) -> None:
    for each in processes:
        with suppress(OSError):
            os.kill(each, what)


def used() -> tuple[int, bool]:
    """Of all that is below this process: the processor time [ticks], and whether any wants more.

    Where nobody can see that, it may want more.
    """
    if not _is_seen():
        return 0, True
    below = linux.descendants(os.getpid()).values()
    used = sum(stat.ticks + stat.waited_ticks for stat in below)
    return used, any(stat.state in ("R", "D") for stat in below)


def _is_seen() -> bool:
    """Whether /proc has all processes; at `landlock` a process may not list it."""
    try:
        os.scandir(_PROC).close()
    except PermissionError:
        return False
    return True


def _children() -> set[int]:
    """The children of this process, by trying the numbers that were given since it began.

    What is below them becomes a child when they end.
    """
    last = int((_PROC / "loadavg").read_text().split()[-1])
    first = os.getpid() + 1
    if last < first:  # the numbers have begun anew
        first, last = 2, int((_PROC / "sys/kernel/pid_max").read_text())
    found = set()
    for number in range(first, last + 1):
        with suppress(ChildProcessError):
            os.waitid(os.P_PID, number, os.WEXITED | os.WNOHANG | os.WNOWAIT)
            found.add(number)
    return found
