"""A folder for each run that goes with it, at the latest when the next run looks round.

All of them, and the locks of cores and ROS domains, lie in one folder that is this user's alone.
Its name can be guessed, and everybody may write where it lies: what another has put there is gone
round. Whatever lies in it and is no lock of ours is nobody's, and goes.
"""

from __future__ import annotations

import os
import stat
import tempfile
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from grader import locks, system
from grader.errors import GraderFailure
from grader.language.phrase import say
from grader.removal import remove

PREFIX = "run-"
#: The lock of a folder lies beside it: Windows removes and renames nothing that holds an open file.
LOCK = ".lock"
#: So many names for a folder are tried; one is enough, unless somebody removes its lock each time.
MOST_TRIES = 100


def home() -> Path:
    """Where this user's runs, and the locks of their ROS domains, are: below the system's /tmp.

    Where somebody else was there first: where else only this user may write.

    Raises:
        GraderFailure: there is no such place.
    """
    refused = []
    for folder in _places():
        try:
            _make_own(folder)
        except OSError as error:
            refused.append(f"{folder}: {error.strerror or error}")
        else:
            return folder
    raise GraderFailure(
        say(
            "there is no place for the files of a run ({refused}). Have the first "
            "of these removed, or set TMPDIR to a folder that only you may write "
            "into.",
            refused="; ".join(refused),
        )
    )


def _places() -> Iterator[Path]:
    """Where the folder may be, best first; later ones are only for those whose place is taken."""
    with suppress(FileNotFoundError):  # no /tmp that can be written into
        yield home_below(Path(tempfile.gettempdir()))
    if runtime := os.environ.get("XDG_RUNTIME_DIR"):
        yield Path(runtime) / "turtlesim-grader"
    with suppress(RuntimeError):  # a user without a home
        yield Path.home() / ".cache" / "turtlesim-grader"


def home_below(folder: Path) -> Path:
    """What this user's is called in a folder that is everybody's."""
    return folder / f"turtlesim-grader-{system.user()}"


def _make_own(folder: Path) -> None:
    """Make a folder that only this user may write into, or find that it is one.

    Raises:
        OSError: it cannot be made, or is something else; the text says whose.
    """
    with suppress(FileExistsError):
        folder.mkdir(mode=0o700, parents=True)
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode):
        kind = "a link" if stat.S_ISLNK(found.st_mode) else "no folder"
        raise NotADirectoryError(f"it is {kind}, and belongs to {system.owner(found)}")
    if not system.is_own(found):
        raise PermissionError(f"it belongs to {system.owner(found)}")
    if os.name == "posix" and found.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        folder.chmod(0o700)


def take_lock(name: str) -> IO[str] | None:
    """Take the lock of a name among all of this user's gradings; it is held until it is closed.

    The file stays there for the next one. What is in its place and is no lock goes.

    Returns:
        None where somebody else has it, or where it cannot be had.

    Raises:
        GraderFailure: there is no place for locks.
    """
    path = home() / f"{name}{LOCK}"
    for _ in range(2):
        try:
            file = locks.open_file(path)
        except OSError:
            remove(path)
            continue
        if locks.take(file) and locks.is_in_place(file, path):
            return file
        file.close()
        break
    return None


@contextmanager
def make_folder() -> Iterator[Path]:
    """An empty folder, removed at the end of the context.

    A grader that is killed cannot remove its own; its lock is free then, and the next one does.

    Raises:
        GraderFailure: there is no place for it.
    """
    place = home()
    _clear(place)
    for _ in range(MOST_TRIES):
        path = place / f"{PREFIX}{uuid.uuid4().hex[:12]}"
        beside = path.with_suffix(LOCK)
        with locks.open_file(beside) as lock:
            # else another, who looked round between two of our steps, took it for a leftover
            if locks.take(lock) and locks.is_in_place(lock, beside):
                path.mkdir(mode=0o700)
                try:
                    yield path
                finally:
                    remove(path)
                    _forget(beside)
                break
    else:
        raise GraderFailure(
            say(
                "somebody removes the locks of runs in {place}; find out who does",
                place=str(place),
            )
        )
    _forget(beside)


def _clear(place: Path) -> None:
    """Remove the folders of runs that are no more."""
    with suppress(OSError):
        for run in {name.removesuffix(LOCK) for name in _names(place) if name.startswith(PREFIX)}:
            _clear_one(place / run, place / f"{run}{LOCK}")


def _names(folder: Path) -> list[str]:
    return [entry.name for entry in folder.iterdir()]


def _clear_one(path: Path, beside: Path) -> None:
    try:
        with locks.open_file(beside) as lock:
            # a folder is made after its lock, and goes before it: one without is left over, too
            if not locks.take(lock):
                return
            remove(path)
            _forget(beside)
    except OSError:
        remove(beside)
    _forget(beside)


def _forget(lock: Path) -> None:
    """Remove a lock; on Windows, not while it is open."""
    with suppress(OSError):
        lock.unlink(missing_ok=True)
