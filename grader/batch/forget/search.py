"""Search all files of a folder for names: the proof that nothing is left."""

from __future__ import annotations

import os
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from grader.batch.names.replacing import Names
from grader.recording import bag

#: Pictures have no texts.
_PICTURES: Final = (".png", ".jpg")


def files_with(folder: Path, names: Names) -> list[Path]:
    """Return the files of a folder with names in them or in their paths, packed ones too."""
    known: dict[tuple[int, int], bool] = {}  # a recording is linked into several folders
    return [path for path in _below(folder) if _has(path, folder, names, known)]


def _below(folder: Path) -> Iterator[Path]:
    for at, _, found in os.walk(folder):
        yield from (Path(at, name) for name in sorted(found))


def _has(path: Path, folder: Path, names: Names, known: dict[tuple[int, int], bool]) -> bool:
    if names.are_in(str(path.relative_to(folder))):
        return True
    if path.suffix in _PICTURES or path.is_symlink() or not path.is_file():
        return False
    status = path.stat()
    same = status.st_dev, status.st_ino
    if same not in known:
        known[same] = any(names.are_in(text) for text in _texts(path))
    return known[same]


def _texts(path: Path) -> Iterator[str]:
    if path.suffix == ".mcap":
        try:
            channels = bag.read_channels(path)
        except Exception:  # no bag, or a damaged one; its readers raise anything
            channels = []
        for channel in channels:
            yield f"{channel.topic} {channel.msgtype}"
            if "/Image" not in channel.msgtype:
                yield from (data.decode("utf-8", "replace") for data in channel.messages())
        return
    if path.suffix == ".zip":
        try:
            with zipfile.ZipFile(path) as archive:
                for member in archive.infolist():
                    yield member.filename
                    yield archive.read(member).decode("utf-8", "replace")
        except (OSError, ValueError, zipfile.BadZipFile):
            pass
        return
    yield path.read_bytes().decode("utf-8", "replace")
