"""The members of a zip or a tar, read without trusting its headers."""

from __future__ import annotations

import gzip
import stat
import tarfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import IO, Final

from grader.message import NOTHING, Message, msg
from grader.submission.folder import shown
from grader.submission.safe_members import PACK_AGAIN, Bounded, Budget, ListTooLong, Member

#: Of the list of members, all of them. It is read at once, and becomes 50 times as large.
MAX_LIST_BYTES: Final = 6_000_000

# bits of the general purpose flags (APPNOTE.TXT 4.4.4)
_ENCRYPTED: Final = 0x1
_UTF_8: Final = 0x800

MAX_HEADERS: Final = 50_000  # with those of caches and venvs, which are not written
MAX_HEADER_BYTES: Final = 100_000  # of one header, with the long names that come before it

_LONG: Final = msg(
    "one of its headers has more than {max_header_bytes:g} kB",
    max_header_bytes=MAX_HEADER_BYTES / 1e3,
)
_GZIP: Final = b"\x1f\x8b"
_CHUNK_BYTES: Final = 1 << 16


@contextmanager
def opened_zip(archive: Path, most: int | None = None) -> Iterator[list[Member]]:
    """Open a zip: its members.

    Args:
        most: so large the list of members may be [bytes]; else as large as a submission's.

    Raises:
        ListTooLong: there are too many members, or their names are too long.
        NotImplementedError: it is packed in a way that Python does not know.
        Exception: it is damaged; see `archive.DAMAGED`.
    """
    most = most or MAX_LIST_BYTES
    why = msg("its list has more than {most:g} MB", most=most / 1e6)
    with Bounded(archive, most, why) as file, zipfile.ZipFile(file) as packed:
        yield [
            Member(
                _name(info),
                info.filename.endswith(("/", "\\")),
                _refusal_of_zip(info),
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


def _refusal_of_zip(info: zipfile.ZipInfo) -> Message:
    path = shown(_name(info).replace("\\", "/"))
    if info.flag_bits & _ENCRYPTED:
        return msg(
            "is encrypted: {path} asks for a password. Pack it again without a password.", path=path
        )
    kind = stat.S_IFMT(info.external_attr >> 16)
    if kind == stat.S_IFLNK:
        return msg(
            "holds {path} as a symbolic link. Pack it again with the file itself in that place.",
            path=path,
        )
    if kind not in (0, stat.S_IFREG):
        return msg(
            "holds {path}, which is not an ordinary file. {pack_again}",
            path=path,
            pack_again=PACK_AGAIN,
        )
    return NOTHING


@contextmanager
def opened_tar(
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
        yield Member(info.name, info.isdir(), _refusal_of_tar(info), partial(_file, packed, info))


def _file(packed: tarfile.TarFile, info: tarfile.TarInfo) -> IO[bytes]:
    file = packed.extractfile(info)
    if file is None:
        raise tarfile.ReadError("a member has no content")
    return file


def _refusal_of_tar(info: tarfile.TarInfo) -> Message:
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
