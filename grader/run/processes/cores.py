"""One processor core for both processes of a run: they take turns, and a core need not wake up."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

_getaffinity, _setaffinity = os.sched_getaffinity, os.sched_setaffinity


def available() -> list[int]:
    """The cores that this process may use."""
    return sorted(_getaffinity(0))


@contextmanager
def reserve_core(run: int) -> Iterator[int]:
    """Hold a core that, if possible, no other run on this machine holds.

    Args:
        run: any number; spreads the runs over the cores where there are more runs than cores.
    """
    # here: the processes of a run import this module too, and need no locks
    import fcntl

    from grader import scratch

    possible = available()
    folder = scratch.home()
    with ExitStack() as locks:
        for core in possible:
            lock = locks.enter_context((folder / f"core-{core}.lock").open("w"))
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            break
        else:
            core = possible[run % len(possible)]
        yield core


def pin(core: int) -> None:
    """Keep all threads of this process on a core; those to come follow. -1: on any."""
    if core < 0:
        return
    with suppress(OSError):  # not allowed, or no /proc
        for thread in Path("/proc/self/task").iterdir():
            with suppress(OSError):  # ended meanwhile
                _setaffinity(int(thread.name), {core})
