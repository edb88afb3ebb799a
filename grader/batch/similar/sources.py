"""The Python files of a hand-in, kept with its result: DIR/submissions/ID/source/.

They are what JPlag and Dolos compare (`export`). A name that
not every system takes is made one that it does; what is too much is left out, and that is told.
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Final, NamedTuple

from grader.errors import SubmissionError
from grader.submission.folder import MAX_SOURCE_BYTES, files_below, read_bounded

SOURCE: Final = "source"
MOST_FILES: Final = 60
MOST_BYTES: Final = 1_000_000  # of all of them together
_STRANGE = re.compile(r"[^A-Za-z0-9._+-]|^[.-]")


class File(NamedTuple):
    """A file that was kept: its name below the folder, with '/', and what is in it."""

    name: str
    data: bytes


def keep(copy: Path, into: Path) -> int:
    """Copy the sources of a submission into a folder, which is made anew.

    Args:
        copy: its private copy; nothing is followed that leads out of it.

    Returns:
        How many were left out.

    Raises:
        OSError: a folder cannot be written, or what was handed in cannot be read.
    """
    if into.exists():
        shutil.rmtree(into)
    into.mkdir(parents=True)
    taken: set[str] = set()
    size = left_out = 0
    for path in _sources(copy):
        data = read_bounded(path)
        if data is None or len(taken) >= MOST_FILES or size + len(data) > MOST_BYTES:
            left_out += 1
            continue
        size += len(data)
        target = into / _free_name(path.relative_to(copy), taken)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(data)
    return left_out


def kept(folder: Path) -> list[File]:
    """What `keep` has put into a folder, by name; nothing where there is none.

    Raises:
        OSError: it cannot be read.
    """
    if folder.is_symlink():
        return []  # none of ours
    paths = [path for path in folder.rglob("*.py") if path.is_file() and not path.is_symlink()]
    named = sorted((path.relative_to(folder).as_posix(), path) for path in paths)
    return [File(name, _begin(path)) for name, path in named[:MOST_FILES]]


def _begin(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(MAX_SOURCE_BYTES)


def _sources(copy: Path) -> Iterator[Path]:
    base = os.path.realpath(copy)
    try:
        found = files_below(copy)
    except SubmissionError:  # too many files: whoever could be graded has fewer
        return
    for path in found:
        inside = Path(os.path.realpath(path)).is_relative_to(base)
        if path.suffix == ".py" and path.is_file() and inside:
            yield path


def _free_name(path: Path, taken: set[str]) -> str:
    """A name for a file that no other has, whatever a system does with capital letters."""
    parts = [_STRANGE.sub("_", part)[:80] for part in path.with_suffix("").parts]
    stem, number = "/".join(parts), 1
    name = f"{stem}.py"
    while name.lower() in taken:
        number += 1
        name = f"{stem}_{number}.py"
    taken.add(name.lower())
    return name
