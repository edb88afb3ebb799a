"""Files as bytes that can be sent, and the same as files again.

A parcel is a tar file: texts by their names, and trees of files, each below a name of its own.
"""

from __future__ import annotations

import gzip
import io
import os
import tarfile
import zlib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Literal

from grader.language.phrase import say
from grader.submission.private_copy import UNREADABLE

#: Of all that goes into a parcel, unpacked [bytes]: more than a submission may have.
MOST_BYTES = 250_000_000
#: Files, folders and links: likewise.
MOST_MEMBERS = 20_000
#: Of each of them, what stands before it and fills it up [bytes].
HEAD_BYTES = 4096


Trust = Literal["tar", "data"]


class Unfit(Exception):
    """It is too large for a parcel, or it is no parcel; the text says which."""


def _nothing(path: Path) -> bool:
    return False


def pack(
    texts: Mapping[str, bytes],
    trees: Mapping[str, Path],
    is_left_out: Callable[[Path], bool] = _nothing,
) -> bytes:
    """Put texts and trees into a parcel: files, folders, links as links.

    Args:
        texts: by names without a slash.
        trees: a file or a folder each, by names with a slash in it or of a folder.
        is_left_out: what below a tree stays here.

    Raises:
        Unfit: they are too large.
        OSError: something cannot be read.
    """
    buffer = io.BytesIO()
    left = _Room()
    with tarfile.open(fileobj=buffer, mode="w:gz", compresslevel=1) as tar:
        for name, text in texts.items():
            info = tarfile.TarInfo(name)
            info.size = left.take(len(text))
            tar.addfile(info, io.BytesIO(text))
        for name, top in trees.items():
            for path in (top, *_below(top, is_left_out)):
                _add(tar, path, (name / path.relative_to(top)).as_posix(), left)
    return buffer.getvalue()


def unpack(parcel: bytes, folder: Path, trust: Trust = "data") -> dict[str, bytes]:
    """Put the trees of a parcel into a folder; returns the texts.

    Args:
        trust: a filter of `tarfile`. "data" refuses links that lead elsewhere; "tar" has them, as
            they were handed in: whoever opens a submission sees to them.

    Raises:
        Unfit: it is no parcel of ours, or too large.
        OSError: something cannot be written.
    """
    texts = {}
    left = _Room()
    try:
        with tarfile.open(fileobj=_Bounded(fileobj=io.BytesIO(parcel)), mode="r:") as tar:
            for info in tar:
                left.take(info.size)
                if "/" not in info.name and info.isfile():
                    file = tar.extractfile(info)
                    texts[info.name] = b"" if file is None else file.read()
                else:
                    _extract(tar, info, folder, trust)
    except (tarfile.TarError, gzip.BadGzipFile, zlib.error, EOFError, ValueError) as error:
        raise Unfit(say("damaged: {why}", why=str(error))) from None
    return texts


def _extract(tar: tarfile.TarFile, info: tarfile.TarInfo, folder: Path, trust: Trust) -> None:
    try:
        tar.extract(info, folder, filter=trust)
    except OSError as error:  # its path may be longer here than there; a run leaves it out, too
        if trust != "tar" or error.errno not in UNREADABLE:
            raise


class _Bounded(gzip.GzipFile):
    """Unpacks no more than a parcel may hold: a head in it may say that it has gigabytes."""

    def read(self, size: int | None = -1) -> bytes:
        left = MOST_BYTES + MOST_MEMBERS * HEAD_BYTES - self.tell()
        return super().read(left if size is None or size < 0 else max(min(size, left), 0))


class _Room:
    """What a parcel has room for."""

    def __init__(self) -> None:
        self._bytes, self._members = MOST_BYTES, MOST_MEMBERS

    def take(self, size: int) -> int:
        """Take some for one more member, and hand its size back."""
        self._bytes -= size
        self._members -= 1
        if self._bytes < 0 or self._members < 0:
            raise Unfit(
                say(
                    "it has more than {megabytes:g} MB, or more than {files:,} files",
                    megabytes=MOST_BYTES / 1e6,
                    files=MOST_MEMBERS,
                )
            )
        return size


def _add(tar: tarfile.TarFile, path: Path, name: str, left: _Room) -> None:
    info = tarfile.TarInfo(name)
    found = path.lstat()
    info.mtime = int(found.st_mtime)
    if path.is_symlink():
        info.type, info.linkname = tarfile.SYMTYPE, os.fspath(path.readlink())
    elif path.is_dir():
        info.type, info.mode = tarfile.DIRTYPE, 0o755
    elif path.is_file():
        info.size, info.mode = found.st_size, (found.st_mode & 0o111) | 0o644
    else:  # a pipe, socket or device: it would be waited for
        return
    left.take(info.size)
    if info.isfile():
        with path.open("rb") as file:
            tar.addfile(info, file)
    else:
        tar.addfile(info)


def _below(top: Path, is_left_out: Callable[[Path], bool]) -> Iterator[Path]:
    """What lies in a folder; a folder comes before what is in it."""
    if top.is_dir() and not top.is_symlink():
        for path in sorted(top.iterdir()):
            if not is_left_out(path):
                yield path
                yield from _below(path, is_left_out)
