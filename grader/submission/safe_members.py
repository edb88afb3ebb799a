"""Checks the members of an archive of any kind, and writes those that may be: none is trusted."""

from __future__ import annotations

import io
import lzma
import os
import re
import struct
import tarfile
import zipfile
import zlib
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import IO, Final

from grader.errors import SubmissionError
from grader.submission.folder import (
    BEGINNING_BYTES,
    MAX_BYTES,
    RESULT,
    is_junk,
    is_result,
    is_source,
    marks_generated,
)
from grader.text.message import Message, msg
from grader.text.strings import shown

MAX_MEMBERS: Final = 10_000  # but for caches, venvs and colcon's output
MAX_NAME: Final = 1_000  # characters, with all folders; a path on disk may have a few more
MAX_NAME_BYTES: Final = 250  # of a file or folder; file systems allow 255
MAX_HEADERS: Final = 50_000  # of a tar, with those of caches and venvs, which are not written
#: Of the list of a zip's members. It is read at once, and becomes 50 times as large.
MAX_LIST_BYTES: Final = 6_000_000
PACK_AGAIN: Final = msg("Pack your .py file or package folder into a new .zip and hand that in.")
#: What may be wrong with a member.
LOCKED: Final = msg(
    "{name} is encrypted: {path} asks for a password. Pack it again without a password."
)
LINK: Final = msg(
    "{name} holds {path} as a link. Pack it again with the file itself in that place."
)
SPECIAL: Final = msg("{name} holds {path}, which is not an ordinary file. {pack_again}")

_CHUNK_BYTES: Final = 1 << 16
#: What an archive that is damaged, or made to look so, makes its reader raise.
DAMAGED: Final = (
    *(zipfile.BadZipFile, tarfile.TarError, zlib.error, lzma.LZMAError, struct.error, EOFError),
    *(ValueError, OverflowError, RuntimeError),
)


@dataclass(frozen=True)
class Member:
    """One entry of an archive.

    Attributes:
        name: as it stands there.
        is_folder: it holds nothing itself.
        fault: what is wrong with it, if anything.
        open: opens its content.
    """

    name: str
    is_folder: bool
    fault: Message
    open: Callable[[], IO[bytes]]


#: Called with the name of a member that cannot be written, and why; what it raises refuses the
#: archive.
Report = Callable[[str, Exception], None]


def refuse(_: str, error: Exception) -> None:
    """Refuse an archive for one of its members: what a student hands in is whole."""
    raise error


class ListTooLong(Exception):
    """An archive lists more than any submission has; the text says how much more."""


class Bounded(io.BufferedReader):
    """A file of which not much can be read at once, for parsers of member lists.

    Args:
        most: so many bytes can be read at once.
        why: of the refusal.
    """

    def __init__(self, path: Path, most: int, why: Message) -> None:
        super().__init__(io.FileIO(path))
        self._most, self._why = most, why

    def read(self, size: int | None = -1, /) -> bytes:
        """Read as any file does, but not more than allowed.

        Raises:
            ListTooLong: it would be more.
        """
        if size is not None and size > self._most:
            raise ListTooLong(self._why)
        data = super().read(self._most + 1 if size is None or size < 0 else size)
        if len(data) > self._most:
            raise ListTooLong(self._why)
        return data


class TooMuch(SubmissionError):
    """An archive holds more than it may."""


@dataclass
class Budget:
    """How much may still come out of an archive, and of those inside of it, together.

    Attributes:
        most_bytes: of the file, and of all that comes out of it: those of a submission.
        most_files: but for caches, venvs and colcon's output.
        list_bytes: of the list of a zip's members.
        headers: of a tar.
    """

    most_bytes: int = MAX_BYTES
    most_files: int = MAX_MEMBERS
    list_bytes: int = MAX_LIST_BYTES
    headers: int = MAX_HEADERS

    def __post_init__(self) -> None:
        self._bytes_left, self._files_left = self.most_bytes, self.most_files

    def count_bytes(self, name: str, count: int) -> None:
        """Count bytes that came out of the archive of this name.

        Raises:
            TooMuch: they are too many.
        """
        self._bytes_left -= count
        if self._bytes_left < 0:
            raise self.too_large(name)

    def too_large(self, name: str) -> TooMuch:
        """The refusal of an archive of this name, which has more bytes, packed or unpacked."""
        return TooMuch(
            "{name} holds more than {all_bytes:g} MB, the limit for a submission. Leave out "
            "recordings, videos and virtual environments, and pack it again.",
            name=name,
            all_bytes=self.most_bytes / 1e6,
        )

    def count_files(self, name: str, count: int) -> None:
        """Count files that an archive holds.

        Raises:
            TooMuch: they are too many.
        """
        self._files_left -= count
        if self._files_left < 0:
            raise TooMuch(
                "{name} holds {count:,} files; the limit for a submission is "
                "{all_files:,}. {pack_again}",
                name=name,
                count=count,
                all_files=self.most_files,
                pack_again=PACK_AGAIN,
            )


def write(
    name: str, members: Sequence[Member], into: Path, budget: Budget, report: Report = refuse
) -> None:
    """Write what really comes out, and count it: the sizes in an archive are only claims.

    Args:
        report: called with each member that is no plain file, would be written elsewhere, or cannot
            be read or written.
    """
    for path, member in _chosen(name, members, budget, report):
        target = into / path
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            with member.open() as source, target.open("wb") as file:
                while chunk := source.read(_CHUNK_BYTES):
                    budget.count_bytes(name, len(chunk))
                    file.write(chunk)
        except (*DAMAGED, NotImplementedError, OSError) as error:
            report(member.name, error)


def _chosen(
    name: str, members: Sequence[Member], budget: Budget, report: Report
) -> list[tuple[PurePosixPath, Member]]:
    """Check the members and return the files to write; directories are made on the way."""
    everything: list[tuple[PurePosixPath, Member]] = []
    for member in members:
        try:
            everything.append((_inside(name, member.name), member))
        except SubmissionError as error:
            report(member.name, error)
    # .parent.name is "" at the top: a submission is never left out as a whole
    marks = [path for path, _ in everything if marks_generated(path) and path.parent.name]
    results = {path.parent for path, member in everything if _is_result(path, member)}
    sources = {path.parent for path, _ in everything if is_source(path.name)}
    left_out = {mark.parent for mark in marks} | (results - sources)
    chosen = [
        (path, member)
        for path, member in everything
        if not member.is_folder
        and not any(is_junk(folder) for folder in path.parts[:-1])
        and left_out.isdisjoint(path.parents)
    ]
    if not chosen:
        raise SubmissionError(
            "{name} is an empty archive: it holds no files. {pack_again}",
            name=name,
            pack_again=PACK_AGAIN,
        )
    budget.count_files(name, len(chosen))
    for path, member in chosen:
        if member.fault:
            words = {"name": name, "path": shown(path), "pack_again": PACK_AGAIN}
            report(member.name, SubmissionError(member.fault.given(**words)))
    return [(path, member) for path, member in chosen if not member.fault]


def _is_result(path: PurePosixPath, member: Member) -> bool:
    """Whether it is the result of an earlier grading, in a folder of its own."""
    if path.name != RESULT or not path.parent.name or member.is_folder or member.fault:
        return False
    with suppress(*DAMAGED, NotImplementedError, OSError), member.open() as source:
        return is_result(source.read(BEGINNING_BYTES))
    return False  # which is told when it is written


def _inside(name: str, member: str) -> PurePosixPath:
    """Turn a member's name into a path; some Windows programs write it with backslashes."""
    text = member.replace("\\", "/")
    if len(text) > MAX_NAME:
        raise SubmissionError(
            "{name} holds a name of {length:,} characters ({member}); the limit is "
            "{max_name:,}. {pack_again}",
            name=name,
            length=len(text),
            member=shown(member),
            max_name=MAX_NAME,
            pack_again=PACK_AGAIN,
        )
    path = PurePosixPath(text)
    if path.is_absolute() or ".." in path.parts or re.match("[A-Za-z]:/", text):
        raise SubmissionError(
            "{name} holds {member}, which would be written outside of its own folder. {pack_again}",
            name=name,
            member=shown(member),
            pack_again=PACK_AGAIN,
        )
    return PurePosixPath(*map(short, path.parts))


def short(part: str) -> str:
    """Shorten a name for the file system; its end, with the suffix, stays."""
    if len(os.fsencode(part)) <= MAX_NAME_BYTES:
        return part
    end = part[-30:]
    begin = part.encode("utf-8", "surrogateescape")[: MAX_NAME_BYTES - len(os.fsencode(end)) - 3]
    return f"{begin.decode('utf-8', 'ignore')}…{end}"
