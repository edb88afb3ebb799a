"""The archive of a whole class, unpacked as strangers' archives are, and within larger limits.

It was made by a course's server, but of what students have named and filled. It is read in a copy
of this process that has limits (`grader.limited`); nothing is written outside of its folder, and no
link. What is wrong with one member keeps out that one and is told: one student must not keep the
others from being graded. What is inside of the students' own archives is not looked at here.
"""

from __future__ import annotations

import errno
import json
import os
import re
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import IO, Final

from grader import limited, strict_json
from grader.errors import UsageError
from grader.submission import tar_archive, zip_archive
from grader.submission.archive import DAMAGED
from grader.submission.archive_members import Budget, ListTooLong, Member
from grader.submission.folder import MAX_BYTES, is_junk, listed, marks_generated, shown

MAX_FILES: Final = 500_000
MAX_ALL_BYTES: Final = 50_000_000_000
MAX_LIST_BYTES: Final = 100_000_000  # of the list of a zip's members
#: A file that is too large for a submission is cut here, and so refused when it is graded.
MAX_FILE_BYTES: Final = MAX_BYTES + 1
LIMITS: Final = limited.Limits(cpu_s=3600, wall_s=4 * 3600, memory_bytes=3 * 2**30)
_MAX_PART_BYTES: Final = 200  # of a name; file systems take 255
_CHUNK_BYTES: Final = 1 << 16
#: What of a repository says when it was committed to (`git_time.py`); no configuration, no hooks.
_OF_GIT: Final = ("HEAD", "objects", "packed-refs", "refs")
_UNWRITABLE: Final = (
    *(errno.EINVAL, errno.EILSEQ, errno.ENAMETOOLONG),
    *(errno.ENOTDIR, errno.EISDIR, errno.EEXIST),
)
_INSTEAD: Final = "Unpack it yourself, and give the folder."


def unpack(archive: Path, into: Path) -> list[str]:
    """Write what is in the archive of a class below `into`, a folder to be made.

    Returns:
        What to say about it.

    Raises:
        UsageError: it is damaged, or too large.
    """
    into.mkdir()
    name = shown(archive.name)
    try:
        said = strict_json.loads(limited.call(lambda: _answer(archive, into), LIMITS).decode())
    except limited.LimitHit as hit:
        raise UsageError(f"{name} cannot be unpacked: that {hit}. {_INSTEAD}") from None
    if "refused" in said:
        raise UsageError(str(said["refused"]))
    return [str(note) for note in said["notes"]]


def _answer(archive: Path, into: Path) -> bytes:
    name = shown(archive.name)
    try:
        return json.dumps({"notes": _Unpacking(name, into).unpack(archive)}).encode()
    except UsageError as error:
        why = error.message
    except ListTooLong as error:
        why = f"{name} lists more than any class hands in: {error}. {_INSTEAD}"
    except (*DAMAGED, NotImplementedError, OSError) as error:
        told = shown(str(error) or "it ends too early")
        why = f"{name} cannot be unpacked: {told}. Download it again, or unpack it yourself."
        if isinstance(error, OSError) and error.errno == errno.ENOSPC:
            why = f"{name} cannot be unpacked: {into} has no space left. {_INSTEAD}"
    return json.dumps({"refused": why}).encode()


class _Room(Budget):
    """What may come out of the archive of a class."""

    def __init__(self) -> None:
        super().__init__(MAX_ALL_BYTES, MAX_FILES)

    def take_bytes(self, name: str, count: int) -> None:
        self._bytes_left -= count
        if self._bytes_left < 0:
            most = f"{MAX_ALL_BYTES / 1e9:g} GB, the limit for a class"
            raise UsageError(f"{name} unpacks to more than {most}. {_INSTEAD}")

    def take_files(self, name: str, count: int) -> None:
        self._files_left -= count
        if self._files_left < 0:
            most = f"{MAX_FILES:,} files, the limit for a class"
            raise UsageError(f"{name} holds more than {most}. {_INSTEAD}")


class _Unpacking:
    """An unpacking in progress.

    Attributes:
        odd: names of members, by what is odd about them.
    """

    def __init__(self, name: str, into: Path) -> None:
        self.name, self.into = name, into
        self.odd: dict[str, list[str]] = defaultdict(list)
        self._room = _Room()
        self._made: set[Path] = {into}

    def unpack(self, archive: Path) -> list[str]:
        with _members(archive, self.into.with_suffix(".tar")) as members:
            for path, member in self._chosen(members):
                self._room.take_files(self.name, 1)
                try:
                    self._write(path, member)
                except OSError as error:
                    if error.errno not in _UNWRITABLE:
                        raise
                    self.odd["cannot be written here"].append(member.name)
        return [
            f"Of what {self.name} holds, some {what}: {listed(names)}."
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
                what = "is encrypted, a link or no ordinary file, and left out"
                self.odd[what].append(member.name)
            else:
                yield path, member

    def _inside(self, member: Member) -> PurePosixPath | None:
        """Where a member belongs, with names that can be written; None: nowhere in here."""
        text = member.name.replace("\\", "/")
        path = PurePosixPath(text)
        if path.is_absolute() or ".." in path.parts or re.match("[A-Za-z]:/", text):
            self.odd["would be written outside of its folder, and is left out"].append(member.name)
            return None
        return PurePosixPath(*map(_short, path.parts)) if path.parts else None

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
            except (*DAMAGED, NotImplementedError):  # what came out stays: it was handed in
                self.odd["is damaged, and kept as far as it goes"].append(member.name)

    def _copy(self, member: Member, source: IO[bytes], file: IO[bytes]) -> None:
        left = MAX_FILE_BYTES
        while left and (chunk := source.read(min(_CHUNK_BYTES, left))):
            self._room.take_bytes(self.name, len(chunk))
            file.write(chunk)
            left -= len(chunk)
        if not left:
            what = f"has more than {MAX_BYTES / 1e6:g} MB, too much for a submission, and is cut"
            self.odd[what].append(member.name)


@contextmanager
def _members(archive: Path, plain: Path) -> Iterator[Sequence[Member]]:
    if archive.suffix.lower() == ".zip":
        with zip_archive.opened(archive, MAX_LIST_BYTES) as members:
            yield members
    else:
        with tar_archive.opened(archive, plain, MAX_FILES, _Room()) as members:
            yield members


def _belongs(path: PurePosixPath) -> bool:
    """Whether no part of a path is hidden or junk, but for what says when it was committed."""
    for at, part in enumerate(path.parts):
        if part == ".git" and at and path.parts[at + 1 : at + 2]:
            return path.parts[at + 1] in _OF_GIT
        if is_junk(part) and part != ".classroom50.yml":
            return False
    return True


def _short(part: str) -> str:
    """A name that is not too long for a file system; the end, which says the kind, stays."""
    if len(os.fsencode(part)) <= _MAX_PART_BYTES:
        return part
    end = part[-30:]
    begin = part.encode("utf-8", "surrogateescape")[: _MAX_PART_BYTES - len(os.fsencode(end)) - 3]
    return f"{begin.decode('utf-8', 'ignore')}…{end}"
