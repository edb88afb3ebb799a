"""The limits guard: ends a submission whose processes together use too much.

The kernel's limits (`grader.run.limits.rlimits`) hold for each process alone, and control groups,
which count whole families, are available to a grader almost nowhere: not in containers, not to
users. So a thread of the grader measures, five times a second, and ends a family that uses too
much.
Between two measurements, of a millisecond each, a core can fill a few hundred MiB at most.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable
from typing import NamedTuple

import psutil

from grader.run.limits import LIMITS, MIB, CpuBudget, RunLimits, size
from grader.system import linux
from grader.system.linux import ProcessStat
from grader.text.message import NOTHING, msg

#: How often usage is measured [s].
EVERY_S = 0.2
#: So much memory of the machine used since the last close measurement makes the next one due.
HURRY_BYTES = 256 * MIB
#: This near to the limit of processes the kernel has refused one: some belong to the grader, and
#: some have ended since.
NEAR = 12


class FamilyUsage(NamedTuple):
    """What a family of processes uses at once.

    Attributes:
        memory_bytes: the pages of each, with those of files and those that several share.
        tasks: its processes and threads.
        files: their open descriptors; 0 before Linux 6.2, which does not count them.
        ticks: their processor time, and that of the children that they have waited for [ticks].
    """

    memory_bytes: int
    tasks: int
    files: int
    ticks: int


class LimitsGuard:
    """Watches the descendants of some processes, until it is stopped.

    Attributes:
        remark: what they used too much of, for the result; NOTHING for none.
    """

    def __init__(self, limits: RunLimits = LIMITS, budget: CpuBudget | None = None) -> None:
        """Start watching, within a budget of the grading."""
        self.remark = NOTHING
        self._family, self._limits = Family(), limits
        self._ends: list[Callable[[], None]] = []
        self._printed_bytes: list[Callable[[], int]] = []
        self._budget, self._seen_ticks = budget or CpuBudget(), 0
        self._has_ended = False
        self._next_close_measurement, self._available = 0.0, 0
        self._is_over = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()

    def add(
        self, ancestor: int, end: Callable[[], None], printed_bytes: Callable[[], int] = lambda: 0
    ) -> None:
        """Watch the descendants of a process; the limits are those of all together.

        Args:
            end: called, in a separate thread, when they are to be ended.
            printed_bytes: returns how much they have printed.
        """
        self._ends.append(end)
        self._printed_bytes.append(printed_bytes)
        self._family.add(ancestor)

    def stop(self) -> None:
        self._is_over.set()
        self._thread.join()

    def measure_last(self) -> bool:
        """Measure once more, and stop; return whether they are ended, now or before."""
        self.stop()
        self._next_close_measurement = 0.0
        if not self._has_ended and self._is_too_much():
            self._end_all()
        return self._has_ended

    def _watch(self) -> None:
        while not self._is_over.wait(EVERY_S):
            if self._is_too_much():
                self._end_all()
                return

    def _end_all(self) -> None:
        self._has_ended = True
        for end in tuple(self._ends):
            end()

    def _is_too_much(self) -> bool:
        limits = self._limits
        found = self._family.usage()
        self._budget.spend(max(0, found.ticks - self._seen_ticks) / linux.TICKS_PER_S)
        self._seen_ticks = max(self._seen_ticks, found.ticks)
        if self._budget.is_spent:
            self.remark = self._budget.remark
            return True
        if found.tasks > limits.tasks - NEAR:
            self.remark = msg(
                "the node and what it started came to the limit of {number} processes and "
                "threads: a run may have no more at once",
                number=limits.tasks,
            )
        if found.tasks > limits.tasks + NEAR:
            return True
        if sum(printed() for printed in tuple(self._printed_bytes)) > limits.output_bytes:
            self.remark = msg(
                "the node and what it started printed more than {size}, and were ended: a run may "
                "print no more",
                size=size(limits.output_bytes),
            )
        elif found.files > limits.family_files:
            self.remark = msg(
                "the node and what it started had {number} open files and sockets at once, and "
                "were ended: a run may have {most}",
                number=found.files,
                most=limits.family_files,
            )
        elif found.memory_bytes > limits.family_bytes and self._is_too_much_memory():
            self.remark = msg(
                "the node and what it started used more than {size} of memory, and were ended: a "
                "run may use no more",
                size=size(limits.family_bytes),
            )
        else:
            return False
        return True

    def _is_too_much_memory(self) -> bool:
        """Measure closely: without pages of files, and with shared pages counted once.

        A measurement takes a millisecond a process. It gets a tenth of our time, and is made at
        once where the machine's memory shrinks.
        """
        began, available = time.monotonic(), psutil.virtual_memory().available
        if began < self._next_close_measurement and available > self._available - HURRY_BYTES:
            return False
        memory = self._family.private_memory_bytes()
        self._next_close_measurement = began + 10 * (time.monotonic() - began)
        self._available = available
        return memory > self._limits.family_bytes


class Family:
    """The descendants of some processes, found anew for each measurement."""

    def __init__(self, *ancestors: int) -> None:
        self._ancestors = set(ancestors)
        #: Processes that are not in the family, and never will be.
        self._others: set[int] = set()

    def add(self, ancestor: int) -> None:
        """Add the descendants of another process."""
        self._ancestors = {*self._ancestors, ancestor}  # it may be read meanwhile
        self._others = set()

    def usage(self) -> FamilyUsage:
        """Measure their usage quickly, without the ancestors."""
        members = self._members()
        memory = sum(member.memory_bytes for member in members.values())
        tasks = sum(member.tasks for member in members.values())
        ticks = sum(member.ticks + member.waited_ticks for member in members.values())
        return FamilyUsage(memory, tasks, sum(map(_open_files, members)), ticks)

    def private_memory_bytes(self) -> int:
        """Measure their memory without files'; pages that several share count once [bytes]."""
        return sum(_private_memory_bytes(pid, stat) for pid, stat in self._members().items())

    def _members(self) -> dict[int, ProcessStat]:
        there = linux.process_ids()
        self._others = self._others & there
        found = {
            pid: stat for pid in there - self._others if (stat := linux.process_stat(pid)).state
        }
        ancestors = self._ancestors
        members = {pid: found[pid] for pid in linux.below(ancestors, found)}
        # one whose parent has just ended has a new one, and is found the next time
        rest = {pid: found[pid] for pid in found.keys() - members.keys() - ancestors}
        self._others |= linux.below(self._others | {0}, rest)
        return members


def _open_files(pid: int) -> int:
    """Count the open descriptors of a process; 0 where the system does not show them."""
    try:
        return os.stat(f"/proc/{pid}/fd").st_size  # noqa: PTH116
    except OSError:
        return 0


def _private_memory_bytes(pid: int, stat: ProcessStat) -> int:
    """Return a process's share of memory without files' [bytes]; all of it where that is hidden."""
    try:
        with open(f"/proc/{pid}/smaps_rollup", "rb", buffering=0) as file:  # noqa: PTH123
            lines = file.readall().splitlines()
    except OSError:
        return stat.memory_bytes
    parts = (line.split() for line in lines)
    names = (b"Pss_Anon:", b"Pss_Shmem:", b"SwapPss:")
    return sum(int(words[1]) * 1024 for words in parts if words and words[0] in names)
