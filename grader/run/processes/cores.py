"""One processor core for both processes of a run: they take turns, and a core need not wake up."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

#: Where the kernel shows the quotas of control groups, and to which this process belongs.
_CGROUPS, _MEMBERSHIP = Path("/sys/fs/cgroup"), Path("/proc/self/cgroup")


def available() -> list[int]:
    """Return the cores that this process may use."""
    return sorted(os.sched_getaffinity(0))


def share() -> float:
    """Return how many cores this process may keep busy; a container may have a part of one."""
    return min([float(len(available())), *_quotas()])


def _quotas() -> Iterator[float]:
    """Yield the quotas of this process's control groups [cores]; of version 1 they are not read."""
    with suppress(OSError, ValueError, ZeroDivisionError):
        # of version 2, as a path below the root that this process sees
        lines = _MEMBERSHIP.read_text().splitlines()
        own = next((line.removeprefix("0::") for line in lines if line.startswith("0::")), "")
        group = _CGROUPS.joinpath(*own.split("/"))
        for folder in (group, *group.parents):
            if folder.is_relative_to(_CGROUPS) and (folder / "cpu.max").exists():
                quota, period = (folder / "cpu.max").read_text().split()
                if quota != "max":
                    yield int(quota) / int(period)


@contextmanager
def reserve_core(run: int) -> Iterator[int]:
    """Hold a core that, if possible, no other run on this machine holds.

    Args:
        run: any number; spreads the runs over the cores where there are more runs than cores.
    """
    # here: the processes of a run import this module too, and need no locks
    from grader.system import scratch

    possible = available()
    with scratch.hold_one("core", possible) as core:
        yield possible[run % len(possible)] if core is None else core


def pin(core: int, *pids: int) -> None:
    """Keep all threads of processes on a core; those to come follow."""
    with suppress(OSError):  # not allowed, gone, or no /proc
        for thread in (each for pid in pids for each in Path(f"/proc/{pid}/task").iterdir()):
            with suppress(OSError):  # ended meanwhile
                os.sched_setaffinity(int(thread.name), {core})
