"""Unpacks a handed-in zip without trusting it: nothing outside its folder, no links, no bomb."""

from __future__ import annotations

import errno
import io
import lzma
import re
import stat
import struct
import zipfile
import zlib
from pathlib import Path, PurePosixPath
from typing import Final

from grader.errors import SubmissionError
from grader.submission.folder import MAX_BYTES, is_junk, marks_generated, shown

MAX_MEMBERS: Final = 10_000  # but for caches, venvs and colcon's output
MAX_NAME: Final = 1_000  # characters, with all folders; a path on disk may have a few more
#: Of the list of members, all of them. It is read at once, and becomes 50 times as large.
MAX_LIST_BYTES: Final = 6_000_000
_CHUNK_BYTES: Final = 1 << 16

_ENCRYPTED: Final = 0x1  # bit 0 of the general purpose flags (APPNOTE.TXT 4.4.4)
_DAMAGED: Final = (
    *(zipfile.BadZipFile, zlib.error, lzma.LZMAError, struct.error, EOFError),
    *(ValueError, OverflowError, RuntimeError),
)
# damage as an OSError: bz2's has no number, EINVAL is a position before the file's start; the
# others are members in each other's way
_DAMAGED_ERRNOS: Final = (
    *(None, errno.EINVAL, errno.ENOTDIR),
    *(errno.EISDIR, errno.EEXIST, errno.ENAMETOOLONG),
)
_PACK_AGAIN: Final = "Pack your .py file or package folder into a new .zip and hand that in."

_Member = tuple[PurePosixPath, zipfile.ZipInfo]


class _ListTooLong(Exception):
    """More was to be read at once than the list of a zip's members may have."""


class _Bounded(io.BufferedReader):
    """A file of which zipfile cannot read much at once; only the list of the members is that."""

    def __init__(self, path: Path) -> None:
        super().__init__(io.FileIO(path))

    def read(self, size: int | None = -1, /) -> bytes:
        """Read as any file does; but not more than the longest list.

        Raises:
            _ListTooLong: it would be more.
        """
        if size is not None and size > MAX_LIST_BYTES:
            raise _ListTooLong
        data = super().read(MAX_LIST_BYTES + 1 if size is None or size < 0 else size)
        if len(data) > MAX_LIST_BYTES:
            raise _ListTooLong
        return data


def unpack(archive: Path, into: Path) -> None:
    """Write the files of a zip below `into`; caches, venvs and colcon's output stay out.

    Raises:
        SubmissionError: it is empty, damaged, encrypted or too large, or it reaches outside.
    """
    name = shown(archive.name)
    size = archive.stat().st_size
    if size == 0:
        raise SubmissionError(f"{name} is empty (0 bytes). {_PACK_AGAIN}")
    if size > MAX_BYTES:
        raise _too_large(name)
    try:
        with _Bounded(archive) as file, zipfile.ZipFile(file) as packed:
            _write(name, packed, _members(name, packed.infolist()), into)
    except _ListTooLong as error:
        raise SubmissionError(
            f"{name} lists too many files, or too long names: its list has more than "
            f"{MAX_LIST_BYTES / 1e6:g} MB. {_PACK_AGAIN}"
        ) from error
    except NotImplementedError as error:
        raise SubmissionError(
            f"{name} is packed in a way that cannot be read here ({shown(str(error))}). "
            f"{_PACK_AGAIN}"
        ) from error
    except _DAMAGED as error:
        raise _damaged(name, str(error) or "it ends too early") from error
    except OSError as error:
        if error.errno not in _DAMAGED_ERRNOS:
            raise
        raise _damaged(name, error.strerror or str(error)) from error


def _damaged(name: str, why: str) -> SubmissionError:
    return SubmissionError(f"{name} cannot be unpacked as a zip file: {shown(why)}. {_PACK_AGAIN}")


def _too_large(name: str) -> SubmissionError:
    return SubmissionError(
        f"{name} unpacks to more than {MAX_BYTES / 1e6:g} MB, the limit for a submission. "
        "Leave out recordings, videos and virtual environments, and pack it again."
    )


def _members(name: str, infos: list[zipfile.ZipInfo]) -> list[_Member]:
    """Check the members and keep the files to write; directories are made on the way."""
    everything = [(_inside(name, info.filename), info) for info in infos]
    # .parent.name is "" at the top of the zip: what was handed in is never left out as a whole
    marks = [path for path, _ in everything if marks_generated(path) and path.parent.name]
    left_out = {mark.parent for mark in marks}
    members = [
        (path, info)
        for path, info in everything
        if not info.filename.endswith(("/", "\\"))
        and not any(is_junk(folder) for folder in path.parts[:-1])
        and left_out.isdisjoint(path.parents)
    ]
    if not members:
        raise SubmissionError(f"{name} is an empty zip: it holds no files. {_PACK_AGAIN}")
    if len(members) > MAX_MEMBERS:
        raise SubmissionError(
            f"{name} holds {len(members):,} files; the limit for a submission is "
            f"{MAX_MEMBERS:,}. {_PACK_AGAIN}"
        )
    for path, info in members:
        _must_be_plain(name, path, info)
    return members


def _inside(name: str, member: str) -> PurePosixPath:
    """Turn a member's name into a path; some Windows programs write it with backslashes."""
    text = member.replace("\\", "/")
    if len(text) > MAX_NAME:
        raise SubmissionError(
            f"{name} holds a name of {len(text):,} characters ({shown(member)}); the limit is "
            f"{MAX_NAME:,}. {_PACK_AGAIN}"
        )
    path = PurePosixPath(text)
    if path.is_absolute() or ".." in path.parts or re.match("[A-Za-z]:/", text):
        raise SubmissionError(
            f"{name} holds {shown(member)}, which would be written outside of its own folder. "
            f"{_PACK_AGAIN}"
        )
    return path


def _must_be_plain(name: str, path: PurePosixPath, info: zipfile.ZipInfo) -> None:
    if info.flag_bits & _ENCRYPTED:
        raise SubmissionError(
            f"{name} is encrypted: {shown(path)} asks for a password. "
            "Pack it again without a password."
        )
    kind = stat.S_IFMT(info.external_attr >> 16)
    if kind == stat.S_IFLNK:
        raise SubmissionError(
            f"{name} holds {shown(path)} as a symbolic link. "
            "Pack it again with the file itself in that place."
        )
    if kind not in (0, stat.S_IFREG):
        raise SubmissionError(
            f"{name} holds {shown(path)}, which is not an ordinary file. {_PACK_AGAIN}"
        )


def _write(name: str, packed: zipfile.ZipFile, members: list[_Member], into: Path) -> None:
    """Write what really comes out, and count it: the sizes in a zip's header are only claims."""
    left = MAX_BYTES
    for path, info in members:
        target = into / path
        target.parent.mkdir(parents=True, exist_ok=True)
        with packed.open(info) as source, target.open("wb") as file:
            while chunk := source.read(_CHUNK_BYTES):
                left -= len(chunk)
                if left < 0:
                    raise _too_large(name)
                file.write(chunk)
