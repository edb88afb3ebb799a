"""Unpack the archive of a whole class, as untrusted as a student's, within larger limits.

A course's server made it, but with names and contents from students. A copy of this process with
limits reads it (`grader.limited`); nothing is written outside of its folder, and no link. A member
that cannot be unpacked is left out and reported: one student must not keep the others from being
graded. The students' archives inside of it are not unpacked here.
"""

from __future__ import annotations

import errno
import re
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import IO, Final

from grader import limited, strict_json
from grader.batch.find.attempt import short
from grader.errors import UsageError
from grader.message import NOTHING, Message, as_message, msg
from grader.submission.archive import DAMAGED, opened_tar, opened_zip
from grader.submission.folder import MAX_BYTES, is_junk, listed, marks_generated, shown
from grader.submission.safe_members import Budget, ListTooLong, Member

MAX_FILES: Final = 500_000
MAX_ALL_BYTES: Final = 50_000_000_000
MAX_LIST_BYTES: Final = 100_000_000  # of the list of a zip's members
#: A file that is too large for a submission is cut here, and so refused when it is graded.
MAX_FILE_BYTES: Final = MAX_BYTES + 1
LIMITS: Final = limited.WorkLimits(cpu_s=3600, wall_s=4 * 3600, memory_bytes=3 * 2**30)
_CHUNK_BYTES: Final = 1 << 16
#: The parts of a repository with the time of its last commit (`clones.py`); no configuration, no
#: hooks.
_OF_GIT: Final = ("HEAD", "objects", "packed-refs", "refs")
_UNWRITABLE: Final = (
    *(errno.EINVAL, errno.EILSEQ, errno.ENAMETOOLONG),
    *(errno.ENOTDIR, errno.EISDIR, errno.EEXIST),
)
#: Notes on members.
_CANNOT_BE_WRITTEN: Final = msg("cannot be written here")
_NO_FILE: Final = msg("is encrypted, a link or no ordinary file, and left out")
_OUTSIDE: Final = msg("would be written outside of its folder, and is left out")
_DAMAGED: Final = msg("is damaged, and kept as far as it goes")
_TOO_LARGE: Final = msg(
    "has more than {size:g} MB, too much for a submission, and is cut", size=MAX_BYTES / 1e6
)
_INSTEAD: Final = msg("Unpack it yourself, and give the folder.")


def unpack(archive: Path, into: Path) -> list[Message]:
    """Unpack the archive of a class into `into`, a folder to be made.

    Returns:
        Notes for the teacher.

    Raises:
        UsageError: it is damaged, or too large.
    """
    into.mkdir()
    name = shown(archive.name)
    try:
        answer = limited.call(lambda: _answer(archive, into), LIMITS)
    except limited.LimitHit as hit:
        raise UsageError(
            "{name} cannot be unpacked: that {hit}. {instead}",
            name=name,
            hit=hit.why,
            instead=_INSTEAD,
        ) from None
    unpacked = strict_json.of_line(_Answer, answer)
    if unpacked.refused:
        raise UsageError(unpacked.refused)
    return list(unpacked.notes)


@dataclass(frozen=True)
class _Answer:
    """The answer of the process that unpacks: notes, or why it refused the archive."""

    notes: tuple[Message, ...] = ()
    refused: Message = NOTHING


def _answer(archive: Path, into: Path) -> bytes:
    name = shown(archive.name)
    try:
        return strict_json.line(_Answer(tuple(_Unpacking(name, into).unpack(archive))))
    except UsageError as error:
        why = error.message
    except ListTooLong as error:
        why = msg(
            "{name} lists more than any class hands in: {error}. {instead}",
            name=name,
            error=error.args[0],
            instead=_INSTEAD,
        )
    except (*DAMAGED, NotImplementedError, OSError) as error:
        why = msg(
            "{name} cannot be unpacked: {why}. Download it again, or unpack it yourself.",
            name=name,
            why=as_message(shown(str(error))) or msg("it ends too early"),
        )
        if isinstance(error, OSError) and error.errno == errno.ENOSPC:
            why = msg(
                "{name} cannot be unpacked: {folder} has no space left. {instead}",
                name=name,
                folder=into,
                instead=_INSTEAD,
            )
    return strict_json.line(_Answer(refused=why))


class _Room(Budget):
    """The budget of bytes and files for the archive of a class."""

    def __init__(self) -> None:
        super().__init__(MAX_ALL_BYTES, MAX_FILES)

    def count_bytes(self, name: str, count: int) -> None:
        self._bytes_left -= count
        if self._bytes_left < 0:
            raise UsageError(
                "{name} unpacks to more than {size:g} GB, the limit for a class. {instead}",
                name=name,
                size=MAX_ALL_BYTES / 1e9,
                instead=_INSTEAD,
            )

    def count_files(self, name: str, count: int) -> None:
        self._files_left -= count
        if self._files_left < 0:
            raise UsageError(
                "{name} holds more than {most:,} files, the limit for a class. {instead}",
                name=name,
                most=MAX_FILES,
                instead=_INSTEAD,
            )


class _Unpacking:
    """An unpacking in progress.

    Attributes:
        odd: note -> names of the members that it is about.
    """

    def __init__(self, name: str, into: Path) -> None:
        self.name, self.into = name, into
        self.odd: dict[Message, list[str]] = defaultdict(list)
        self._room = _Room()
        self._made: set[Path] = {into}

    def unpack(self, archive: Path) -> list[Message]:
        with _members(archive, self.into.with_suffix(".tar")) as members:
            for path, member in self._chosen(members):
                self._room.count_files(self.name, 1)
                try:
                    self._write(path, member)
                except OSError as error:
                    if error.errno not in _UNWRITABLE:
                        raise
                    self.odd[_CANNOT_BE_WRITTEN].append(member.name)
        return [
            msg(
                "Of what {name} holds, some {what}: {names}.",
                name=self.name,
                what=what,
                names=listed(names),
            )
            for what, names in self.odd.items()
        ]

    def _chosen(self, members: Sequence[Member]) -> Iterator[tuple[PurePosixPath, Member]]:
        inside = [(self._inside(member), member) for member in members]
        marks = (path for path, _ in inside if path is not None and marks_generated(path))
        generated = {mark.parent for mark in marks if mark.parent.name}
        for path, member in inside:
            if path is None or not _belongs(path) or not generated.isdisjoint(path.parents):
                continue
            if member.refusal and not member.is_folder:
                self.odd[_NO_FILE].append(member.name)
            else:
                yield path, member

    def _inside(self, member: Member) -> PurePosixPath | None:
        """Return the path of a member, with writable names; None: outside of the folder."""
        text = member.name.replace("\\", "/")
        path = PurePosixPath(text)
        if path.is_absolute() or ".." in path.parts or re.match("[A-Za-z]:/", text):
            self.odd[_OUTSIDE].append(member.name)
            return None
        return PurePosixPath(*map(short, path.parts)) if path.parts else None

    def _write(self, path: PurePosixPath, member: Member) -> None:
        target = self.into / path
        folder = target if member.is_folder else target.parent
        if folder not in self._made:  # one call a folder, and not one a file
            folder.mkdir(parents=True, exist_ok=True)
            self._made.add(folder)
        if member.is_folder:
            return
        with target.open("xb") as file:
            try:
                with member.open() as source:
                    self._copy(member, source, file)
            except (*DAMAGED, NotImplementedError):  # what came out is kept and graded
                self.odd[_DAMAGED].append(member.name)

    def _copy(self, member: Member, source: IO[bytes], file: IO[bytes]) -> None:
        left = MAX_FILE_BYTES
        while left and (chunk := source.read(min(_CHUNK_BYTES, left))):
            self._room.count_bytes(self.name, len(chunk))
            file.write(chunk)
            left -= len(chunk)
        if not left:
            self.odd[_TOO_LARGE].append(member.name)


@contextmanager
def _members(archive: Path, plain: Path) -> Iterator[Sequence[Member]]:
    if archive.suffix.lower() == ".zip":
        with opened_zip(archive, MAX_LIST_BYTES) as members:
            yield members
    else:
        with opened_tar(archive, plain, MAX_FILES, _Room()) as members:
            yield members


def _belongs(path: PurePosixPath) -> bool:
    """Whether no part of a path is hidden or junk, except what holds a commit's time."""
    for at, part in enumerate(path.parts):
        if part == ".git" and at and path.parts[at + 1 : at + 2]:
            return path.parts[at + 1] in _OF_GIT
        if is_junk(part) and part != ".classroom50.yml":
            return False
    return True
