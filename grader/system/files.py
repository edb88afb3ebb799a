"""Writes files whole or not at all, so that half a file is never read.

A path that a caller names is written as named: a link stays a link, a pipe is written to (`write`).
A file with a name of ours, in a folder for results, replaces whatever is there (`put`): the folder
may have come with a submission, and none of its links may lead us elsewhere.
"""

from __future__ import annotations

import contextlib
import errno
import os
import re
import shutil
import stat
import uuid
from collections.abc import Iterable, Iterator
from pathlib import Path

from grader.errors import UsageError
from grader.system import scratch
from grader.text.message import Message, msg

_STREAMS = {"/dev/stdin": 0, "/dev/stdout": 1, "/dev/stderr": 2}
_DESCRIPTOR = re.compile(r"/(?:dev|proc/self)/fd/(\d{1,9})")

#: So much of a file shows its schema [bytes].
_BEGINNING = 200


def cannot_write(path: Path, why: str | Message) -> UsageError:
    """Return the error for a file or folder that cannot be written."""
    return UsageError("cannot write {path}: {why}", path=str(path), why=why)


@contextlib.contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn what the system refuses while a path is written into an error that names the path."""
    try:
        yield
    except OSError as error:
        raise cannot_write(path, error.strerror or str(error)) from None


def write(path: Path, content: str) -> None:
    """Write a text as UTF-8, whole or not at all; folders are made if need be.

    A link stays a link. Devices and pipes are simply written to. The name of one of our
    descriptors (/dev/fd/3) is written by that descriptor: this also works where its file could not
    be opened again, because it is another user's.
    """
    data = content.encode("utf-8")
    with writing(path):
        descriptor = _descriptor(path)
        if descriptor is not None:
            with os.fdopen(os.dup(descriptor), "wb") as file:
                file.write(data)
        elif path.exists() and not path.is_file():
            path.write_bytes(data)
        else:
            _write_beside(_target(path), data)


def check_writable(path: Path, schema: str | None = None, inputs: Iterable[Path] = ()) -> None:
    """Find out whether a file can be written, without changing anything.

    Args:
        schema: how the schema of what may be replaced begins, such as "turtlesim-grader/error/";
            None for any file.
        inputs: what the call reads; folders do not count, since whatever lies in them has a
            schema of its own.
    """
    why_not: str | Message | None
    try:
        why_not = _why_not(path)
    except OSError as error:
        why_not = error.strerror or str(error)
    if why_not:
        raise cannot_write(path, why_not)
    check_is_no_input(path, inputs)
    if schema is not None:
        _check_schema(path, schema)


def _why_not(path: Path) -> Message | None:
    descriptor = _descriptor(path)
    if descriptor is not None:
        import fcntl  # here: Windows lacks it, and has no such paths

        mode = fcntl.fcntl(descriptor, fcntl.F_GETFL) & os.O_ACCMODE
        return msg("it is open for reading only") if mode == os.O_RDONLY else None
    if path.is_dir():
        return msg("it is a folder; expected the name of a file to write")
    if path.exists() and not path.is_file():
        return None if os.access(path, os.W_OK) else msg("you may not write into it")
    there = next(folder for folder in _target(path).parents if os.path.lexists(folder))
    if not there.is_dir() or not os.access(there, os.W_OK | os.X_OK):
        return msg("{there} is no folder that you may write into", there=str(there))
    return None


def _check_schema(path: Path, schema: str) -> None:
    if _descriptor(path) is not None or not path.is_file():
        return
    with writing(path), path.open("rb") as file:
        begin = file.read(_BEGINNING)
    if begin and not re.match(rb'\s*\{\s*"schema"\s*:\s*"' + re.escape(schema.encode()), begin):
        raise cannot_write(
            path,
            msg(
                "there is a file already that this grader has not written; give another name, or "
                "remove it. Nothing was changed."
            ),
        )


def check_is_no_input(path: Path, inputs: Iterable[Path]) -> None:
    """Refuse to write over what a call reads."""
    with contextlib.suppress(OSError):  # what cannot be read is reported where it is read
        for one in inputs:
            if one.is_file() and path.exists() and path.samefile(one):
                raise cannot_write(
                    path, msg("this call reads it; give another name. Nothing was changed.")
                )


def make_folder(folder: Path) -> None:
    """Make a folder, and those above it, where they are not there."""
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)


@contextlib.contextmanager
def filling(folder: Path) -> Iterator[Path]:
    """Yield a path for what fills a new or empty folder, whole or not at all.

    One in which only `.git` lies is empty.
    """
    with writing(folder):
        if folder.exists() and not folder.is_dir():
            raise UsageError(
                "{folder} is a file; give a new folder, nothing was written", folder=folder
            )
        is_new = not folder.exists()
        if not is_new and any(path.name != ".git" for path in folder.iterdir()):  # `git init`
            raise UsageError(
                "{folder} is not empty; give a new folder, nothing was written", folder=folder
            )
        folder.mkdir(parents=True, exist_ok=True)
        unfinished = folder / f".unfinished.{os.getpid()}"
        try:
            yield unfinished
            for path in unfinished.iterdir():
                path.rename(folder / path.name)
        except BaseException:
            shutil.rmtree(folder if is_new else unfinished, ignore_errors=True)
            raise
        unfinished.rmdir()


@contextlib.contextmanager
def sole_writer(folder: Path) -> Iterator[None]:
    """Be the only grading that writes into a folder, as long as the context lasts."""
    lock = scratch.lock_folder(folder)
    if lock is None:
        raise UsageError(
            "another grading writes into {folder}: wait for its end, or give each an --out",
            folder=str(folder),
        )
    try:
        yield
    finally:
        os.close(lock)


def withdraw(path: Path) -> None:
    """Remove what an earlier call has written to a path; a link, a device, a pipe stays."""
    with writing(path):
        if _descriptor(path) is None and path.is_file():
            _target(path).unlink(missing_ok=True)


def put(path: Path, content: bytes) -> None:
    """Write a file of ours, whole or not at all, in place of whatever has its name."""
    with writing(path):
        _write_beside(path, content)


def read_ours(path: Path, most_bytes: int) -> bytes:
    """Read a file of ours from a folder for results, which others may have changed.

    No link is followed and no pipe waited for.
    """
    with open(path, "rb", opener=_open_unfollowed) as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            raise OSError(errno.EINVAL, msg("it is no ordinary file"))
        data = file.read(most_bytes + 1)
    if len(data) > most_bytes:
        raise OSError(errno.EFBIG, msg("it has more than {most:,} bytes", most=most_bytes))
    return data


def _open_unfollowed(path: str, flags: int) -> int:
    return os.open(path, flags | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))


def check_can_put(path: Path, schema: str | None = None, inputs: Iterable[Path] = ()) -> None:
    """Find out whether `put` will work, without changing anything.

    Args:
        schema: see `check_writable`; without one an older file of this name counts as ours.
        inputs: see `check_writable`.
    """
    mode = _mode(path)
    if mode is not None and stat.S_ISDIR(mode):
        raise cannot_write(path, msg("it is a folder; expected a file, or nothing"))
    if mode is not None and stat.S_ISREG(mode) and schema is not None:
        check_is_no_input(path, inputs)
        _check_schema(path, schema)
    check_writable(path.parent / uuid.uuid4().hex)


def check_can_fill(folder: Path) -> None:
    """Find out whether a folder of ours can be made, or filled anew, after `clear`."""
    mode = _mode(folder)
    if mode is not None and not (stat.S_ISDIR(mode) or stat.S_ISLNK(mode)):
        raise cannot_write(folder, msg("it is a file; expected a folder, or nothing"))
    check_writable((folder.parent if mode is None or stat.S_ISLNK(mode) else folder) / "new")


def check_leads_nowhere_else(folder: Path, submitted: Path) -> None:
    """Refuse a folder whose path goes through a link of a submission's.

    Args:
        submitted: a folder with submissions.
    """
    base = os.path.realpath(submitted)
    whole = Path(os.path.abspath(folder))  # noqa: PTH100  resolving would follow the link
    for at in (whole, *whole.parents):
        if at.is_symlink() and Path(os.path.realpath(at.parent)).is_relative_to(base):
            raise cannot_write(
                folder,
                msg(
                    "{at} is a link that lies with the submission; name the folder itself, or "
                    "another",
                    at=str(at),
                ),
            )


def clear(path: Path) -> None:
    """Remove what has a name of ours, unless it is a folder; of a link, the link."""
    mode = _mode(path)
    if mode is not None and not stat.S_ISDIR(mode):
        with writing(path):
            path.unlink(missing_ok=True)


def _mode(path: Path) -> int | None:
    """Return the mode of what is at a path, without following a link; None for nothing."""
    with writing(path), contextlib.suppress(FileNotFoundError, NotADirectoryError):
        return path.lstat().st_mode
    return None


def _write_beside(path: Path, data: bytes) -> None:
    """Write a file beside a path, which it replaces if nothing goes wrong."""
    unfinished = path.with_name(f".{path.name}.{uuid.uuid4().hex[:12]}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished.touch(exist_ok=False)  # not through a link that somebody has put there
        unfinished.write_bytes(data)
        unfinished.replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            unfinished.unlink(missing_ok=True)
        raise


def _target(path: Path) -> Path:
    """Return the path with links followed."""
    return Path(os.path.realpath(path))


def _descriptor(path: Path) -> int | None:
    """Return the number of the descriptor that a path names; None for any other path."""
    name = str(path)
    if name in _STREAMS:
        return _STREAMS[name]
    match = _DESCRIPTOR.fullmatch(name)
    return int(match[1]) if match else None
