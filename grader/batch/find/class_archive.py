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
from grader.language import stored
from grader.language.phrase import say
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
#: What may be odd about some of the members.
_CANNOT_BE_WRITTEN: Final = say("cannot be written here")
_NO_FILE: Final = say("is encrypted, a link or no ordinary file, and left out")
_OUTSIDE: Final = say("would be written outside of its folder, and is left out")
_DAMAGED: Final = say("is damaged, and kept as far as it goes")
_TOO_LARGE: Final = say(
    "has more than {size:g} MB, too much for a submission, and is cut", size=MAX_BYTES / 1e6
)
_INSTEAD: Final = say("Unpack it yourself, and give the folder.")


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
        notes, refused = _from_answer(limited.call(lambda: _answer(archive, into), LIMITS))
    except limited.LimitHit as hit:
        raise UsageError(
            say(
                "{name} cannot be unpacked: that {hit}. {instead}",
                name=name,
                hit=hit.args[0],
                instead=_INSTEAD,
            )
        ) from None
    if refused:
        raise UsageError(refused)
    return notes


def _answer(archive: Path, into: Path) -> bytes:
    name = shown(archive.name)
    try:
        return _to_answer(_Unpacking(name, into).unpack(archive))
    except UsageError as error:
        why = error.message
    except ListTooLong as error:
        why = say(
            "{name} lists more than any class hands in: {error}. {instead}",
            name=name,
            error=error.args[0],
            instead=_INSTEAD,
        )
    except (*DAMAGED, NotImplementedError, OSError) as error:
        why = say(
            "{name} cannot be unpacked: {why}. Download it again, or unpack it yourself.",
            name=name,
            why=shown(str(error)) or say("it ends too early"),
        )
        if isinstance(error, OSError) and error.errno == errno.ENOSPC:
            why = say(
                "{name} cannot be unpacked: {folder} has no space left. {instead}",
                name=name,
                folder=into,
                instead=_INSTEAD,
            )
    return _to_answer(refused=why)


def _to_answer(notes: Sequence[str] = (), refused: str = "") -> bytes:
    said = {"notes": notes, "refused": refused}
    return json.dumps({**said, "phrases": stored.phrases_in(said)}).encode()


def _from_answer(answer: bytes) -> tuple[list[str], str]:
    """The notes, and why nothing was unpacked.

    Raises:
        ValueError: it is no answer.
    """
    said = strict_json.loads(answer.decode())
    texts = [said["refused"], *said["notes"]]
    if not all(isinstance(text, str) for text in texts):
        raise ValueError(f"expected sentences, found {texts!r:.80}")
    refused, *notes = stored.restored(texts, said["phrases"])
    return notes, refused


class _Room(Budget):
    """What may come out of the archive of a class."""

    def __init__(self) -> None:
        super().__init__(MAX_ALL_BYTES, MAX_FILES)

    def take_bytes(self, name: str, count: int) -> None:
        self._bytes_left -= count
        if self._bytes_left < 0:
            raise UsageError(
                say(
                    "{name} unpacks to more than {size:g} GB, the limit for a class. {instead}",
                    name=name,
                    size=MAX_ALL_BYTES / 1e9,
                    instead=_INSTEAD,
                )
            )

    def take_files(self, name: str, count: int) -> None:
        self._files_left -= count
        if self._files_left < 0:
            raise UsageError(
                say(
                    "{name} holds more than {most:,} files, the limit for a class. {instead}",
                    name=name,
                    most=MAX_FILES,
                    instead=_INSTEAD,
                )
            )


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
                    self.odd[_CANNOT_BE_WRITTEN].append(member.name)
        return [
            say(
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
        """Where a member belongs, with names that can be written; None: nowhere in here."""
        text = member.name.replace("\\", "/")
        path = PurePosixPath(text)
        if path.is_absolute() or ".." in path.parts or re.match("[A-Za-z]:/", text):
            self.odd[_OUTSIDE].append(member.name)
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
                self.odd[_DAMAGED].append(member.name)

    def _copy(self, member: Member, source: IO[bytes], file: IO[bytes]) -> None:
        left = MAX_FILE_BYTES
        while left and (chunk := source.read(min(_CHUNK_BYTES, left))):
            self._room.take_bytes(self.name, len(chunk))
            file.write(chunk)
            left -= len(chunk)
        if not left:
            self.odd[_TOO_LARGE].append(member.name)


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
