"""One processor core for both processes of a run: they take turns, and a core need not wake up."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

_getaffinity, _setaffinity = os.sched_getaffinity, os.sched_setaffinity


def available() -> list[int]:
    """The cores that this process may use."""
    return sorted(_getaffinity(0))


def pin(core: int) -> None:
    """Keep all threads of this process on a core; those to come follow. -1: on any."""
    if core < 0:
        return
    with suppress(OSError):  # not allowed, or no /proc
        for thread in Path("/proc/self/task").iterdir():
            with suppress(OSError):  # ended meanwhile
                _setaffinity(int(thread.name), {core})
