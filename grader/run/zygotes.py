"""The two zygotes of this grader process, one for each side of a run in virtual time.

A zygote has imported what nearly every run needs, and forks itself for each: a run then starts in
hundredths of a second instead of half of one. They start with the first run, or earlier by
`warm`, wait for the next one, and end with this process, however that ends. Whatever keeps one
from working costs time, and nothing else: the run starts from nothing.

Cheap to import: the command line starts them before it imports what it needs itself.
"""

from __future__ import annotations

import atexit
import json
import os
import sys
import threading
from collections import Counter
from pathlib import Path

from grader.run.environment import (
    lasting_environment,
    simulator_environment,
    virtual_environment,
)
from grader.run.processes.zygote import Zygote, ZygoteLost, shadows
from grader.scenes import MESSAGES, NAMES

#: What runs as the simulator's process in virtual time.
MODULE = "grader.run.simulator.virtual_main"
#: What runs as the submission's.
SCRIPT = Path(__file__).parent / "student" / "virtual_main.py"
STUDENT, SIMULATOR = "student", "simulator"
#: A zygote that was lost so often is not started again.
MOST_LOSSES = 3

_lock = threading.Lock()
_zygotes: dict[str, Zygote] = {}
#: without a successor, or with one that another environment has
_retired: list[Zygote] = []
_losses: Counter[str] = Counter()


def warm() -> None:
    """Start both now, and do not wait for them; that which imports more comes first."""
    zygote(SIMULATOR)
    zygote(STUDENT)


def for_student(root: Path) -> Zygote | None:
    """What the process of a submission is forked from; None where it has to start from nothing."""
    found = zygote(STUDENT)
    try:
        if found is None or shadows(root, found.preloaded()):
            return None
    except ZygoteLost:
        return None
    return found


def command(side: str) -> list[str]:
    """What starts a side, without its arguments."""
    if side == STUDENT:
        return [sys.executable, str(SCRIPT)]
    return [sys.executable, "-m", MODULE]


def zygote(side: str) -> Zygote | None:
    """That of a side; started if there is none that is as it would be now. None: there is none."""
    words = command(side)
    if side == STUDENT:
        env, needs = virtual_environment(lasting_environment()), json.dumps(MESSAGES)
    else:
        env = simulator_environment(lasting_environment())
        needs = json.dumps((MESSAGES, NAMES))
    if not _is_absolute(env.get("PYTHONPATH", "")):
        return None
    with _lock:
        _retired[:] = [each for each in _retired if not each.has_ended()]
        if there := _zygotes.get(side):
            if not there.is_lost and (list(there.command), there.env) == (words, env):
                return there
            _losses[side] += there.is_lost
            there.retire()
            _retired.append(_zygotes.pop(side))
        if _losses[side] >= MOST_LOSSES:
            return None
        try:
            _zygotes[side] = Zygote(words, env, needs)
        except OSError:
            _losses[side] += 1
        return _zygotes.get(side)


def close() -> None:
    """End both, and wait for that; the next run starts others."""
    with _lock:
        for each in (*_zygotes.values(), *_retired):
            each.close()
        _zygotes.clear()
        _retired.clear()
        _losses.clear()


def _is_absolute(path: str) -> bool:
    """Whether an import path means the same wherever a process stands."""
    return all(Path(entry).is_absolute() for entry in path.split(os.pathsep)) if path else True


def _forget() -> None:
    """In a fork of this process: they are its parent's."""
    global _lock
    _lock = threading.Lock()
    for each in (*_zygotes.values(), *_retired):
        each.forget()
    _zygotes.clear()
    _retired.clear()


atexit.register(close)
os.register_at_fork(after_in_child=_forget)
