"""A folder for each run that goes with it, at the latest when the next run looks round."""

from __future__ import annotations

import shutil
import tempfile
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from grader import locks, system

PREFIX = "run-"
#: The lock of a folder lies beside it: Windows removes and renames nothing that holds an open file.
LOCK = ".lock"


def home() -> Path:
    """Where this user's runs, and the locks of their ROS domains, are: below the system's /tmp."""
    folder = Path(tempfile.gettempdir()) / f"turtlesim-grader-{system.user()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    return folder


@contextmanager
def make_folder() -> Iterator[Path]:
    """An empty folder, removed at the end of the context.

    A grader that is killed cannot remove its own; its lock is free then, and the next one does.
    """
    _clear()
    while True:
        path = home() / f"{PREFIX}{uuid.uuid4().hex[:12]}"
        beside = path.with_suffix(LOCK)
        with beside.open("w") as lock:
            # else another, who looked round between two of our steps, took it for a leftover
            if locks.take(lock) and beside.exists():
                path.mkdir(mode=0o700)
                try:
                    yield path
                finally:
                    shutil.rmtree(path, ignore_errors=True)
                    _forget(beside)
                break
    _forget(beside)


def _clear() -> None:
    """Remove the folders of runs that are no more."""
    for beside in home().glob(f"{PREFIX}*{LOCK}"):
        with suppress(OSError):
            with beside.open() as lock:
                if not locks.take(lock):
                    continue
                shutil.rmtree(beside.with_suffix(""), ignore_errors=True)
                _forget(beside)
            _forget(beside)


def _forget(lock: Path) -> None:
    """Remove a lock; on Windows, not while it is open."""
    with suppress(OSError):
        lock.unlink(missing_ok=True)
