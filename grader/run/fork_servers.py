"""The two fork servers of this grader process, one for each side of a run in virtual time.

Each has imported what nearly every run needs, and forks for each: a run then starts in hundredths
of a second instead of half of one. They start with the first run, or earlier by `warm`, wait for
the next one, and end with this process, however that ends. If one does not work, that costs time
and nothing else: the run makes a cold start.

Cheap to import: the command line starts them before it imports what it needs itself.
"""

from __future__ import annotations

import atexit
import json
import os
import sys
import threading
from collections import Counter
from collections.abc import Collection
from pathlib import Path

from grader.run.environment import (
    lasting_environment,
    simulator_environment,
    virtual_environment,
)
from grader.run.processes.fork_server import ForkServer, ServerLost

#: What runs as the simulator's process in virtual time.
MODULE = "grader.run.simulator.virtual_main"
#: Packages whose messages nearly every submission imports; some may not be there.
MESSAGES = (
    *("geometry_msgs", "std_msgs", "std_srvs", "turtlesim", "turtlesim_msgs"),
    *("sensor_msgs", "tf2_msgs"),
)
#: The scene of nearly every exercise; another is loaded with the first run that needs it.
SCENE = "turtlesim"
#: What runs as the submission's.
SCRIPT = Path(__file__).parent / "student" / "virtual_main.py"
STUDENT, SIMULATOR = "student", "simulator"
#: A server that was lost this often is not started again.
MOST_LOSSES = 3
#: A submission with more files than this is not searched.
MOST_FILES = 10_000

_lock = threading.Lock()
_servers: dict[str, ForkServer] = {}
#: without a successor, or with one that another environment has
_retired: list[ForkServer] = []
_losses: Counter[str] = Counter()


def warm() -> None:
    """Start both now without waiting for them; the one that imports more comes first."""
    server(SIMULATOR)
    server(STUDENT)


def for_student(root: Path) -> ForkServer | None:
    """Return the server for a submission's process; None where that needs a cold start."""
    found = server(STUDENT)
    try:
        if found is None or shadows(root, found.preloaded()):
            return None
    except ServerLost:
        return None
    return found


def shadows(folder: Path, names: Collection[str]) -> bool:
    """Whether a submission has, or may have, a module of one of these names itself.

    A module that a server has loaded would win, where a cold start finds the submission's. It may
    lie anywhere: submissions put folders of theirs on the import path.
    """
    seen = 0
    for place, folders, files in os.walk(folder):
        seen += len(files) + len(folders)
        if seen > MOST_FILES:
            return True
        # "numpy.py", "numpy.cpython-311-x86_64-linux-gnu.so", but not resource/, a mere marker
        modules = (file for file in files if file.endswith((".py", ".pyc", ".so")))
        if any(file.partition(".")[0] in names for file in modules):
            return True
        if any(name in names and (Path(place) / name / "__init__.py").exists() for name in folders):
            return True
    return False


def command(side: str) -> list[str]:
    """Return the command that starts a side, without its arguments."""
    if side == STUDENT:
        return [sys.executable, str(SCRIPT)]
    return [sys.executable, "-m", MODULE]


def _environment(side: str) -> dict[str, str]:
    made = virtual_environment if side == STUDENT else simulator_environment
    return made(lasting_environment())


def server(side: str) -> ForkServer | None:
    """Return the server of a side, started if none with its present environment runs.

    Returns:
        None where it does not start, or was lost too often.
    """
    words, env, needs = command(side), _environment(side), [json.dumps(MESSAGES)]
    if side == SIMULATOR:
        needs.append(SCENE)
    path = env.get("PYTHONPATH")
    if path and not all(Path(entry).is_absolute() for entry in path.split(os.pathsep)):
        return None  # it would mean something else in another current folder
    with _lock:
        _retired[:] = [each for each in _retired if not each.has_ended()]
        if there := _servers.get(side):
            if not there.is_lost and (list(there.command), there.env) == (words, env):
                return there
            _losses[side] += there.is_lost
            there.retire()
            _retired.append(_servers.pop(side))
        if _losses[side] >= MOST_LOSSES:
            return None
        try:
            _servers[side] = ForkServer(words, env, *needs)
        except OSError:
            _losses[side] += 1
        return _servers.get(side)


def close() -> None:
    """End both, and wait for that; the next run starts new ones."""
    with _lock:
        for each in (*_servers.values(), *_retired):
            each.close()
        _servers.clear()
        _retired.clear()
        _losses.clear()


def _forget() -> None:
    """Let go of both in a fork of this process: they are its parent's."""
    global _lock
    _lock = threading.Lock()
    for each in (*_servers.values(), *_retired):
        each.forget()
    _servers.clear()
    _retired.clear()


atexit.register(close)
os.register_at_fork(after_in_child=_forget)
