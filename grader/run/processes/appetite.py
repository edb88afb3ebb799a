"""How much all processes of a submission use together, watched from outside.

The kernel's limits (`sandbox.limits`) hold for each process alone, and control groups, which count
whole families, are given to a grader almost nowhere: not in containers, not to users. So a thread
of the grader looks, five times a second, and ends the family that takes too much. Between two looks
each core can fill a few hundred MiB at most. A look takes about a millisecond.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple

from grader import usage
from grader.run.budget import Budget
from grader.run.processes.sandbox.limits import LIMITS, MIB, Limits, size
from grader.usage import Usage

#: How often it is looked [s].
EVERY_S = 0.2
#: Memory that has gone since the last close look, wherever to, and makes the next one due.
HURRY_BYTES = 256 * MIB
#: So near to the limit of processes the kernel has refused one: some are not a submission's own,
#: and some have ended since.
NEAR = 12


class Taken(NamedTuple):
    """What a family of processes uses at once.

    Attributes:
        memory_bytes: the pages of each, with those of files and those that several share.
        tasks: its processes and threads.
        files: their open descriptors; 0 before Linux 6.2, which does not tell.
        ticks: the processor time that they have taken, and those that they have waited for [ticks].
    """

    memory_bytes: int
    tasks: int
    files: int
    ticks: int


class Appetite:
    """Watches the descendants of a process until it is told to stop.

    Attributes:
        remark: of which there was too much, for the result; '' if of nothing.
    """

    def __init__(
        self,
        ancestor: int,
        end: Callable[[], None],
        limits: Limits = LIMITS,
        budget: Budget | None = None,
        printed_bytes: Callable[[], int] = lambda: 0,
    ) -> None:
        """Begin; `end` is called, in a thread of ours, when they are to be ended.

        Args:
            printed_bytes: tells how much they have printed.
            budget: of their grading, of which they spend.
        """
        self.remark = ""
        self._family, self._limits, self._end = Family(ancestor), limits, end
        self._printed_bytes = printed_bytes
        self._budget, self._seen_ticks = budget or Budget(), 0
        self._has_ended = False
        self._next_close_look, self._available = 0.0, 0
        self._is_over = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Look no more; what has been found stays."""
        self._is_over.set()
        self._thread.join()

    def look_last(self) -> bool:
        """Look once more, and no more: whether they are ended, now or before."""
        self.stop()
        self._next_close_look = 0.0
        if not self._has_ended and self._look():
            self._end_all()
        return self._has_ended

    def _watch(self) -> None:
        while not self._is_over.wait(EVERY_S):
            if self._look():
                self._end_all()
                return

    def _end_all(self) -> None:
        self._has_ended = True
        self._end()

    def _look(self) -> bool:
        """Whether it is too much."""
        limits = self._limits
        found = self._family.look()
        self._budget.spend(max(0, found.ticks - self._seen_ticks) / usage.TICKS_PER_S)
        self._seen_ticks = max(self._seen_ticks, found.ticks)
        if self._budget.is_spent:
            self.remark = self._budget.remark
            return True
        if found.tasks > limits.tasks - NEAR:
            self.remark = (
                "the node and what it started came to the limit of"
                f" {limits.tasks} processes and threads: a run may have no more at once"
            )
        if found.tasks > limits.tasks + NEAR:
            return True
        if self._printed_bytes() > limits.output_bytes:
            self.remark = (
                f"the node and what it started printed more than {size(limits.output_bytes)}, and"
                " were ended: a run may print no more"
            )
            return True
        if found.files > limits.family_files:
            self.remark = (
                f"the node and what it started had {found.files} open files and sockets at once,"
                f" and were ended: a run may have {limits.family_files}"
            )
            return True
        if found.memory_bytes > limits.family_bytes and self._looks_closely():
            self.remark = (
                f"the node and what it started used more than {size(limits.family_bytes)} of"
                " memory, and were ended: a run may use no more"
            )
            return True
        return False

    def _looks_closely(self) -> bool:
        """Whether it is too much memory without what files lend, and with what is shared shared.

        That takes a millisecond a process: a tenth of our time, and at once where memory goes.
        """
        began, available = time.monotonic(), _available_bytes()
        if began < self._next_close_look and available > self._available - HURRY_BYTES:
            return False
        memory = self._family.own_memory_bytes()
        self._next_close_look = began + 10 * (time.monotonic() - began)
        self._available = available
        return memory > self._limits.family_bytes


class Family:
    """All descendants of a process, found again and again."""

    def __init__(self, ancestor: int) -> None:
        self._ancestor = ancestor
        #: Processes that were there and are none of them; they will not become any.
        self._others: set[int] = set()

    def look(self) -> Taken:
        """What they use now, without the ancestor, by what is told quickly."""
        members = self._members()
        memory = sum(member.memory_bytes for member in members.values())
        tasks = sum(member.tasks for member in members.values())
        ticks = sum(member.ticks + member.waited_ticks for member in members.values())
        return Taken(memory, tasks, sum(map(_open_files, members)), ticks)

    def own_memory_bytes(self) -> int:
        """Their memory that is no file's; pages that several share count once [bytes]."""
        return sum(_own_memory(pid, member) for pid, member in self._members().items())

    def _members(self) -> dict[int, Usage]:
        there = {int(name) for name in os.listdir("/proc") if name.isdigit()}  # noqa: PTH208
        self._others &= there
        found = {pid: seen for pid in there - self._others if (seen := usage.look(pid)).state}
        members: dict[int, Usage] = {}
        above = {self._ancestor}
        while children := {pid for pid, seen in found.items() if seen.parent in above} - above:
            members.update((pid, found[pid]) for pid in children - members.keys())
            above |= children
        # whose parent has ended since it was asked has another by now: that one tells, next time
        outside = self._others | {0}
        while (
            children := {pid for pid, seen in found.items() if seen.parent in outside}
            - outside
            - above
        ):
            outside |= children
        self._others = outside
        return members


def _open_files(pid: int) -> int:
    """How many descriptors a process has open; 0 where that is not told."""
    try:
        return os.stat(f"/proc/{pid}/fd").st_size  # noqa: PTH116
    except OSError:
        return 0


def _own_memory(pid: int, seen: Usage) -> int:
    """A process's part of memory that is no file's [bytes]; where nobody may know, all it has."""
    try:
        lines = _read(pid, "smaps_rollup").splitlines()
    except OSError:
        return seen.memory_bytes
    parts = (line.split() for line in lines)
    names = (b"Pss_Anon:", b"Pss_Shmem:", b"SwapPss:")
    return sum(int(words[1]) * 1024 for words in parts if words and words[0] in names)


def _available_bytes() -> int:
    """The memory that the machine could still give; 0 if it does not say."""
    with suppress(OSError, IndexError, ValueError), open("/proc/meminfo", "rb") as file:  # noqa: PTH123
        return int(file.read().partition(b"MemAvailable:")[2].split()[0]) * 1024
    return 0


def _read(pid: int, name: str) -> bytes:
    with open(f"/proc/{pid}/{name}", "rb", buffering=0) as file:  # noqa: PTH123
        return file.readall()
