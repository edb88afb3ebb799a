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
from typing import Final

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
        found = _below(os.getpid())
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


def _below(ancestor: int) -> set[int]:
    """All descendants of a process that are not over yet."""
    children: dict[int, list[int]] = {}
    over: set[int] = set()
    for folder in _PROC.iterdir():
        if folder.name.isdecimal():
            with suppress(OSError, ValueError, IndexError):
                stat = (folder / "stat").read_text("latin-1")
                state, parent = stat.rpartition(")")[2].split()[:2]  # a name may hold anything
                children.setdefault(int(parent), []).append(int(folder.name))
                if state in "ZX":
                    over.add(int(folder.name))
    found: set[int] = set()
    pending = [ancestor]
    while pending:
        below = [each for each in children.get(pending.pop(), []) if each not in found]
        found.update(below)
        pending += below
    return found - over
