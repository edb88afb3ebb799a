"""The members of a tar, compressed by gzip or not, read without trusting its headers."""

from __future__ import annotations

import gzip
import tarfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import IO, Final

from grader.message import NOTHING, Message, msg
from grader.submission.folder import shown
from grader.submission.safe_members import (
    PACK_AGAIN,
    Bounded,
    Budget,
    ListTooLong,
    Member,
)

MAX_HEADERS: Final = 50_000  # with those of caches and venvs, which are not written
MAX_HEADER_BYTES: Final = 100_000  # of one header, with the long names that come before it

_LONG: Final = msg(
    "one of its headers has more than {max_header_bytes:g} kB",
    max_header_bytes=MAX_HEADER_BYTES / 1e3,
)
_GZIP: Final = b"\x1f\x8b"
_CHUNK_BYTES: Final = 1 << 16


@contextmanager
def opened(
    archive: Path, plain: Path, headers: int | None = None, budget: Budget | None = None
) -> Iterator[list[Member]]:
    """Open a tar: its members.

    Args:
        plain: where the tar may lie without its compression; gone afterwards.
        headers: so many members it may have; else as many as a submission.
        budget: what may come out of its compression; else as much as out of a submission's.

    Raises:
        ListTooLong: there are too many members, or their names are too long.
        SubmissionError: it is too large without its compression.
        Exception: it is damaged; see `archive.DAMAGED`.
    """
    with archive.open("rb") as file:
        is_compressed = file.read(len(_GZIP)) == _GZIP
    try:
        if is_compressed:
            _decompress(archive, plain, budget or Budget())
        with (
            Bounded(plain if is_compressed else archive, MAX_HEADER_BYTES, _LONG) as file,
            tarfile.TarFile(fileobj=file, errorlevel=0) as packed,
        ):
            yield list(_members(packed, headers or MAX_HEADERS))
    finally:
        plain.unlink(missing_ok=True)


def _decompress(archive: Path, plain: Path, budget: Budget) -> None:
    name = shown(archive.name)
    with gzip.open(archive) as source, plain.open("xb") as target:
        while chunk := source.read(_CHUNK_BYTES):
            budget.count_bytes(name, len(chunk))
            target.write(chunk)


def _members(packed: tarfile.TarFile, most: int) -> Iterator[Member]:
    for number, info in enumerate(packed):
        if number >= most:
            raise ListTooLong(msg("it has more than {most:,} entries", most=most))
        yield Member(info.name, info.isdir(), _refusal(info), partial(_file, packed, info))


def _file(packed: tarfile.TarFile, info: tarfile.TarInfo) -> IO[bytes]:
    file = packed.extractfile(info)
    if file is None:
        raise tarfile.ReadError("a member has no content")
    return file


def _refusal(info: tarfile.TarInfo) -> Message:
    path = shown(info.name)
    if info.issym() or info.islnk():
        return msg(
            "holds {path} as a link. Pack it again with the file itself in that place.", path=path
        )
    if not info.isreg() or info.issparse():
        return msg(
            "holds {path}, which is not an ordinary file. {pack_again}",
            path=path,
            pack_again=PACK_AGAIN,
        )
    return NOTHING
