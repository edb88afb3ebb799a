"""What a step leaves running when it is over: ended, before the next one begins.

A stranger's set-up may start programs that outlive it, or one that starts others without end. Their
parents gone, they become children of the process that looks (`adopt`), which ends them all.
"""

from __future__ import annotations

import os
import signal
from contextlib import suppress
from ctypes import CDLL
from pathlib import Path
from typing import Final, NamedTuple

_PR_SET_CHILD_SUBREAPER: Final = 36
_PROC: Final = Path("/proc")
#: So often they are looked for: each time those are stopped that were born meanwhile.
_MOST_ROUNDS: Final = 200
_adopts = False


def adopt() -> None:
    """From now on whatever this process starts stays below it, and `end` ends it."""
    global _adopts
    _adopts = CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0) == 0


def end() -> None:
    """End all that is below this process, if it has adopted it."""
    if not _adopts:
        return
    stopped: set[int] = set()
    for _ in range(_MOST_ROUNDS):  # who is stopped has no more children
        found = _below(os.getpid(), _stats())
        if found <= stopped:
            break
        _tell(found - stopped, signal.SIGSTOP)
        stopped |= found
    _tell(stopped, signal.SIGKILL)
    with suppress(ChildProcessError):
        while stopped:
            os.waitpid(-1, 0)


def _tell(processes: set[int], what: signal.Signals) -> None:
    for each in processes:
        with suppress(OSError):
            os.kill(each, what)


def used() -> tuple[int, bool]:
    """Of all that is below this process: the processor time [ticks], and whether any wants more."""
    stats = _stats()
    below = _below(os.getpid(), stats)
    return sum(stats[each].used for each in below), any(stats[each].state in "RD" for each in below)


class _Stat(NamedTuple):
    state: str
    parent: int
    used: int  # of itself and of those that it has waited for [ticks]


def _stats() -> dict[int, _Stat]:
    """Of every process that there is."""
    found = {}
    for folder in _PROC.iterdir():
        if folder.name.isdecimal():
            with suppress(OSError, ValueError, IndexError):
                text = (folder / "stat").read_text("latin-1")
                words = text.rpartition(")")[2].split()  # a name may hold anything
                used = sum(map(int, words[11:15]))
                found[int(folder.name)] = _Stat(words[0], int(words[1]), used)
    return found


def _below(ancestor: int, stats: dict[int, _Stat]) -> set[int]:
    """All descendants of a process that are not over yet."""
    children: dict[int, list[int]] = {}
    for number, stat in stats.items():
        children.setdefault(stat.parent, []).append(number)
    found: set[int] = set()
    pending = [ancestor]
    while pending:
        below = [each for each in children.get(pending.pop(), []) if each not in found]
        found.update(below)
        pending += below
    return {each for each in found if stats[each].state not in "ZX"}
