"""A folder for each run, removed with it, or at the latest by the next run; and locks.

All of them, and the locks of cores and ROS domains, lie in one folder that is this user's alone.
Its name can be guessed, and everybody may write into its parent: what another user has put there is
avoided. Whatever lies in it and is no lock of ours is removed. A lock vanishes with the process
that holds it, however that ends.
"""

from __future__ import annotations

import os
import stat
import tempfile
import uuid
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from grader.errors import GraderFailure
from grader.system.removal import remove

try:
    import fcntl
except ImportError:  # Windows, where recordings are judged, but nothing is run
    fcntl = None  # type: ignore[assignment]

PREFIX = "run-"
#: The lock of a folder lies beside it: it is made before the folder, and removed after it.
LOCK = ".lock"
#: So many names for a folder are tried; one is enough, unless somebody removes its lock each time.
MOST_TRIES = 100


def home() -> Path:
    """Return the folder of this user's runs and locks: below the system's /tmp.

    Where another user has that name there: another place where only this user may write.
    """
    refused = []
    for folder in _places():
        try:
            _make_private(folder)
        except OSError as error:
            refused.append(f"{folder}: {error.strerror or error}")
        else:
            return folder
    raise GraderFailure(
        "there is no place for the files of a run ({refused}). Have the first "
        "of these removed, or set TMPDIR to a folder that only you may write "
        "into.",
        refused="; ".join(refused),
    )


def _places() -> Iterator[Path]:
    """Yield possible places of the folder; later ones only count where the first is occupied."""
    with suppress(FileNotFoundError):  # no /tmp that can be written into
        yield home_below(Path(tempfile.gettempdir()))
    if runtime := os.environ.get("XDG_RUNTIME_DIR"):
        yield Path(runtime) / "turtlesim-grader"
    with suppress(RuntimeError):  # a user without a home
        yield Path.home() / ".cache" / "turtlesim-grader"


def home_below(folder: Path) -> Path:
    """Return the path of this user's folder in a shared one."""
    return folder / f"turtlesim-grader-{os.getuid()}"


def _make_private(folder: Path) -> None:
    """Make a folder that only this user may write into, or check that it is one."""
    with suppress(FileExistsError):
        folder.mkdir(mode=0o700, parents=True)
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode):
        kind = "a link" if stat.S_ISLNK(found.st_mode) else "no folder"
        raise NotADirectoryError(f"it is {kind}, and belongs to {_owner(found)}")
    if found.st_uid != os.geteuid():
        raise PermissionError(f"it belongs to {_owner(found)}")
    if found.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        folder.chmod(0o700)


def _owner(found: os.stat_result) -> str:
    """Return the owner of a file, for a message: a name, or else a number."""
    import pwd  # here: Windows lacks it

    try:
        return pwd.getpwuid(found.st_uid).pw_name
    except KeyError:
        return f"user {found.st_uid}"


@contextmanager
def make_folder() -> Iterator[Path]:
    """Make an empty folder, removed at the end of the context.

    A killed grader cannot remove its folder; its lock is free then, and the next grader does.
    """
    place = home()
    _clear(place)
    for _ in range(MOST_TRIES):
        path = place / f"{PREFIX}{uuid.uuid4().hex[:12]}"
        beside = path.with_suffix(LOCK)
        with _open_lock(beside) as lock:
            # else another grader has removed it as a leftover between two of our steps
            if lock_file(lock) and _is_in_place(lock, beside):
                path.mkdir(mode=0o700)
                try:
                    yield path
                finally:
                    remove(path)
                    _forget(beside)
                return
        _forget(beside)
    raise GraderFailure(
        "somebody removes the locks of runs in {place}; find out who does", place=str(place)
    )


def _clear(place: Path) -> None:
    """Remove the folders of runs that have ended."""
    with suppress(OSError):
        names = [entry.name for entry in place.iterdir() if entry.name.startswith(PREFIX)]
        for run in {name.removesuffix(LOCK) for name in names}:
            _clear_one(place / run, place / f"{run}{LOCK}")


def _clear_one(path: Path, beside: Path) -> None:
    try:
        with _open_lock(beside) as lock:
            # a folder is made after its lock, and goes before it: one without is left over, too
            if lock_file(lock):
                remove(path)
                _forget(beside)
    except OSError:
        remove(beside)


def _forget(lock: Path) -> None:
    with suppress(OSError):
        lock.unlink(missing_ok=True)


# Locks ----------------------------------------------------------------------------------------


def acquire_lock(name: str) -> IO[str] | None:
    """Acquire the lock of a name among all of this user's gradings, held until it is closed.

    The file stays there for the next one. Anything else of its name is removed.

    Returns:
        None where another grading holds it, or where it cannot be opened.
    """
    path = home() / f"{name}{LOCK}"
    for _ in range(2):
        try:
            file = _open_lock(path)
        except OSError:
            remove(path)
            continue
        if lock_file(file) and _is_in_place(file, path):
            return file
        file.close()
        break
    return None


@contextmanager
def hold_one(kind: str, numbers: Iterable[int]) -> Iterator[int | None]:
    """Hold the first of these numbers that no other grading holds; None where all are held."""
    for number in numbers:
        if lock := acquire_lock(f"{kind}-{number}"):
            with lock:
                yield number
            return
    yield None


def lock_folder(folder: Path) -> int | None:
    """Lock a folder, unless it is locked already; on Windows this never fails, and locks nothing.

    Returns:
        A descriptor, whose closing ends the lock; None where another process holds it.
    """
    if fcntl is None:
        return os.open(os.devnull, os.O_RDONLY)
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    if lock_file(descriptor):
        return descriptor
    os.close(descriptor)
    return None


def lock_file(file: IO[str] | int) -> bool:
    """Lock an open file, until it is closed; return False where it is locked already.

    Each `open` counts separately, also within one process.

    Args:
        file: the file, or its descriptor.
    """
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def _open_lock(path: Path) -> IO[str]:
    """Open the file of a lock, which is made if missing, and never changed."""
    return open(path, "r+", opener=_open_private, encoding="utf-8")


def _open_private(path: str, flags: int) -> int:
    descriptor = os.open(path, flags | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK, 0o600)
    found = os.fstat(descriptor)
    if stat.S_ISREG(found.st_mode) and found.st_uid == os.geteuid():
        return descriptor
    os.close(descriptor)
    raise PermissionError(f"{path} is not an ordinary file of this user's")


def _is_in_place(file: IO[str], path: Path) -> bool:
    """Whether an open file still has this name: another grader may have locked a new one."""
    try:
        return os.path.samestat(os.fstat(file.fileno()), path.lstat())
    except OSError:
        return False
