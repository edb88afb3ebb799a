"""The one file or folder that is graded: what an export renamed has its own name again."""

from __future__ import annotations

import os
import shutil
import stat
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from grader.batch.find.attempt import Attempt, Piece
from grader.submission.folder import is_junk

_MAX_LEVELS: Final = 32
_MAX_NAME_BYTES: Final = 200


def staged(attempt: Attempt, place: Path) -> Piece | None:
    """The one file or folder that an attempt is; None where it is empty.

    Args:
        place: a folder to be made, if it takes one; its files are links or copies.

    Raises:
        OSError: something cannot be read or copied.
    """
    pieces = [piece for piece in attempt.pieces if not _is_empty(piece.path)]
    if not pieces:
        return None
    if len(pieces) == 1 and pieces[0].path.is_dir():
        only = _only_file(pieces[0].path) if attempt.alone else None
        return pieces[0] if only is None else Piece(only, only.name)
    if len(pieces) == 1 and pieces[0].path.name == pieces[0].name:
        return pieces[0]
    place.mkdir(parents=True)
    laid = [path for path in (_lay(piece, place) for piece in pieces) if path is not None]
    if len(laid) == 1 and len(pieces) == 1:
        return Piece(laid[0], laid[0].name)
    return Piece(place) if laid else None


def _lay(piece: Piece, place: Path) -> Path | None:
    """Put a file or a folder in its place; links are not followed."""
    target = _free(place, piece.name or piece.path.name)
    mode = piece.path.lstat().st_mode
    if stat.S_ISDIR(mode):
        shutil.copytree(piece.path, target, symlinks=True)
    elif stat.S_ISREG(mode):
        try:
            os.link(piece.path, target)
        except OSError:  # another file system, or not ours to link
            shutil.copyfile(piece.path, target)
    else:
        return None
    return target


def _free(place: Path, name: str) -> Path:
    """A path in a folder for a name that a stranger has given."""
    if name in (".", "..") or "/" in name or os.sep in name or "\0" in name:
        name = "submission"
    stem, dot, ending = name.rpartition(".")
    while len(os.fsencode(name)) > _MAX_NAME_BYTES and len(stem) > 1:
        stem = stem[: len(stem) // 2]
        name = f"{stem}{dot}{ending}"
    target, number = place / name, 2
    while os.path.lexists(target):
        target = place / f"{number}-{name}"
        number += 1
    return target


def _only_file(folder: Path) -> Path | None:
    """The file that a folder holds, if it holds nothing else."""
    try:
        entries = [entry for entry in _entries(folder) if not is_junk(entry.name)]
    except OSError:
        return None
    if len(entries) == 1 and entries[0].is_file(follow_symlinks=False):
        return Path(entries[0].path)
    return None


def _is_empty(path: Path) -> bool:
    """Whether there is no file in a folder, but what a system has left there."""
    if not path.is_dir():
        return False
    level = [path]
    for _ in range(_MAX_LEVELS):
        below: list[Path] = []
        for folder in level:
            try:
                entries = _entries(folder)
            except OSError:
                return False  # whoever grades it will tell why it cannot be read
            for entry in entries:
                if is_junk(entry.name):
                    continue
                if not entry.is_dir(follow_symlinks=False):
                    return False
                below.append(Path(entry.path))
        level = below
    return not level


def _entries(folder: Path) -> Sequence[os.DirEntry[str]]:
    with os.scandir(folder) as entries:
        return list(entries)
