"""A folder for each run that goes with it, at the latest when the next run looks round."""

from __future__ import annotations

import fcntl
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

PREFIX = "run-"
LOCK = "lock"


def home() -> Path:
    """Where this user's runs, and the locks of their ROS domains, are: below the system's /tmp."""
    folder = Path(tempfile.gettempdir()) / f"turtlesim-grader-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    return folder


@contextmanager
def make_folder() -> Iterator[Path]:
    """An empty folder, removed at the end of the context.

    A grader that is killed cannot remove its own; its lock is free then, and the next one does.
    """
    _clear()
    made = Path(tempfile.mkdtemp(prefix="new-", dir=home()))
    with (made / LOCK).open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        # only now may others find it, and see that it is in use
        path = made.rename(made.with_name(made.name.replace("new-", PREFIX, 1)))
        try:
            yield path
        finally:
            shutil.rmtree(path, ignore_errors=True)


def _clear() -> None:
    """Remove the folders of runs that are no more."""
    for path in home().glob(f"{PREFIX}*"):
        with suppress(OSError), (path / LOCK).open() as lock:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            shutil.rmtree(path, ignore_errors=True)
