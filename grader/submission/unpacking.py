"""Unpacks an archive without trusting it: nothing outside its folder, no links, no bomb.

It is a submission's, or that of a whole class. A zip in a zip of a submission is unpacked as well
(`opened.py`); all levels share one `Budget`.
"""

from __future__ import annotations

import errno
import gzip
import stat
import tarfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import IO, Final

from grader.errors import SubmissionError
from grader.submission.safe_members import (
    DAMAGED,
    LINK,
    LOCKED,
    PACK_AGAIN,
    SPECIAL,
    Bounded,
    Budget,
    ListTooLong,
    Member,
    Report,
    refuse,
    write,
)
from grader.text.message import NOTHING, Message, msg
from grader.text.strings import shown

# damage as an OSError: bz2's and gzip's have no number, EINVAL is a position before the file's
# start; the others are members in each other's way
_DAMAGED_ERRNOS: Final = (
    *(None, errno.EINVAL, errno.ENOTDIR),
    *(errno.EISDIR, errno.EEXIST, errno.ENAMETOOLONG),
)

# bits of the general purpose flags (APPNOTE.TXT 4.4.4)
_ENCRYPTED: Final = 0x1
_UTF_8: Final = 0x800

MAX_HEADER_BYTES: Final = 100_000  # of one header, with the long names that come before it

_LONG: Final = msg(
    "one of its headers has more than {max_header_bytes:g} kB",
    max_header_bytes=MAX_HEADER_BYTES / 1e3,
)
_GZIP: Final = b"\x1f\x8b"
_CHUNK_BYTES: Final = 1 << 16


def unpack(archive: Path, into: Path, budget: Budget, report: Report = refuse) -> None:
    """Write the files of an archive below `into`; caches, venvs and colcon's output stay out.

    Args:
        into: an empty folder.
        report: see `safe_members.write`.
    """
    name = shown(archive.name)
    size = archive.stat().st_size
    if size == 0:
        raise SubmissionError(
            "{name} is empty (0 bytes). {pack_again}", name=name, pack_again=PACK_AGAIN
        )
    if size > budget.most_bytes:
        raise budget.too_large(name)
    is_zip = archive.suffix.lower() == ".zip"
    try:
        with (
            _opened_zip(archive, budget)
            if is_zip
            else _opened_tar(archive, into.with_suffix(".tar"), budget)
        ) as members:
            write(name, members, into, budget, report)
    except (ListTooLong, NotImplementedError, *DAMAGED, OSError) as error:
        if isinstance(error, OSError) and error.errno not in _DAMAGED_ERRNOS:
            raise
        text = getattr(error, "strerror", None) or Message.of(error)
        raise SubmissionError(
            "{name} cannot be unpacked as a {kind} file: {why}. {pack_again}",
            name=name,
            kind="zip" if is_zip else "tar",
            why=Message.of(text).map_texts(shown) or msg("it ends too early"),
            pack_again=PACK_AGAIN,
        ) from error


# Its members, read without trusting its headers ------------------------------------------------


@contextmanager
def _opened_zip(archive: Path, budget: Budget) -> Iterator[list[Member]]:
    most = budget.list_bytes
    why = msg("its list has more than {most:g} MB", most=most / 1e6)
    with Bounded(archive, most, why) as file, zipfile.ZipFile(file) as packed:
        yield [
            Member(
                _name(info),
                info.filename.endswith(("/", "\\")),
                _fault_of_zip(info),
                partial(packed.open, info),
            )
            for info in packed.infolist()
        ]


def _name(info: zipfile.ZipInfo) -> str:
    """A member's name, also where a program writes UTF-8 without its flag, as that of macOS."""
    if info.flag_bits & _UTF_8 or info.filename.isascii():
        return info.filename
    try:
        return info.filename.encode("cp437").decode("utf-8")
    except UnicodeError:
        return info.filename


def _fault_of_zip(info: zipfile.ZipInfo) -> Message:
    if info.flag_bits & _ENCRYPTED:
        return LOCKED
    kind = stat.S_IFMT(info.external_attr >> 16)
    if kind == stat.S_IFLNK:
        return LINK
    return NOTHING if kind in (0, stat.S_IFREG) else SPECIAL


@contextmanager
def _opened_tar(archive: Path, plain: Path, budget: Budget) -> Iterator[list[Member]]:
    """Open a tar: its members.

    Args:
        plain: where the tar may lie without its compression; gone afterwards.
    """
    with archive.open("rb") as file:
        is_compressed = file.read(len(_GZIP)) == _GZIP
    try:
        if is_compressed:
            _decompress(archive, plain, replace(budget))
        with (
            Bounded(plain if is_compressed else archive, MAX_HEADER_BYTES, _LONG) as file,
            tarfile.TarFile(fileobj=file, errorlevel=0) as packed,
        ):
            yield list(_members(packed, budget.headers))
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
        yield Member(info.name, info.isdir(), _fault_of_tar(info), partial(_file, packed, info))


def _file(packed: tarfile.TarFile, info: tarfile.TarInfo) -> IO[bytes]:
    file = packed.extractfile(info)
    if file is None:
        raise tarfile.ReadError("a member has no content")
    return file


def _fault_of_tar(info: tarfile.TarInfo) -> Message:
    if info.issym() or info.islnk():
        return LINK
    return NOTHING if info.isreg() and not info.issparse() else SPECIAL
