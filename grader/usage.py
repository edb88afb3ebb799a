"""What a process does and has used, as /proc/PID/stat tells it; see proc_pid_stat(5)."""

from __future__ import annotations

import os
from typing import NamedTuple

TICKS_PER_S = os.sysconf("SC_CLK_TCK")
PAGE_BYTES = os.sysconf("SC_PAGE_SIZE")


class Usage(NamedTuple):
    """A look at a process; where there is no such process, nothing but zeros.

    Attributes:
        state: the kernel's letter for what it does; '' if there is no such process.
        parent: the process id of its parent.
        ticks: the processor time that it has used [ticks].
        waited_ticks: that of its children which it has waited for [ticks].
        tasks: its threads.
        memory_bytes: its pages, with those of files and those that it shares.
        env: where what it was started with as its environment begins and ends [addresses].
    """

    state: str = ""
    parent: int = 0
    ticks: int = 0
    waited_ticks: int = 0
    tasks: int = 0
    memory_bytes: int = 0
    env: tuple[int, int] = (0, 0)

    @property
    def cpu_s(self) -> float:
        """The processor time that it has used [s]."""
        return self.ticks / TICKS_PER_S

    @property
    def is_stopped(self) -> bool:
        """Whether somebody has stopped it, by SIGSTOP or as a debugger does."""
        return self.state in ("T", "t")

    @property
    def has_ended(self) -> bool:
        """Whether there is no such process, or only its exit code."""
        return self.state in ("", "Z", "X")


def look(pid: int) -> Usage:
    """What a process has used, and does now."""
    try:
        with open(f"/proc/{pid}/stat", "rb", buffering=0) as file:  # noqa: PTH123  pathlib is slow
            state, *words = file.readall().rpartition(b")")[2].split()
    except OSError:
        return Usage()
    # the number of a word is that of the manual's field less four
    parent, (user, system, *waited) = int(words[0]), map(int, words[10:14])
    tasks, pages, env = int(words[16]), int(words[20]), (int(words[46]), int(words[47]))
    letter = state.decode("ascii")
    return Usage(letter, parent, user + system, sum(waited), tasks, pages * PAGE_BYTES, env)
