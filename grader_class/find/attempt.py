"""What every layout of an export is read into: attempts of persons, with their times."""

from __future__ import annotations

import os
import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from grader.submission import is_junk
from grader.text import NOTHING, Message, listed, one_line, shown
from grader_class.entry import Person

_MAX_NAME = 200  # characters of a person's name or id
#: ISO 8601, and its variants in names of files: 2026-11-01_12-30-05, 20261101T123005Z;
#: Ruby's YAML has nanoseconds and a space before the zone.
_TIME: Final = re.compile(
    r"(?P<year>\d{4})-?(?P<month>\d\d)-?(?P<day>\d\d)"
    r"(?:(?:T|[ _-]+|, )(?P<hour>\d\d)[:.h-]?(?P<minute>\d\d)"
    r"(?:[:.-]?(?P<second>\d\d)(?:[.,](?P<fraction>\d{1,9}))?)?)?"
    r" ?(?P<zone>Z|UTC|[+-]\d\d:?\d\d|)"
)
_ISO: Final = "{year}-{month}-{day}T{hour}:{minute}:{second}.{fraction}{zone}"
#: Moodle's format in English, without the day of the week before it.
_MOODLE: Final = ("%d %B %Y, %I:%M %p", "%d %B %Y, %H:%M")
_EPOCH: Final = re.compile(r"\d{10}|\d{13}")  # seconds, milliseconds since 1970


@dataclass(frozen=True)
class Item:
    """A file or folder directly in the folder of a class.

    Attributes:
        is_folder: whether it is a folder; False for a link to one.
        name: its name, composed (NFC): macOS decomposes letters and their accents.
    """

    path: Path
    is_folder: bool
    name: str


@dataclass(frozen=True)
class Piece:
    """A submitted file or folder.

    Attributes:
        name: its original name, before the export renamed it; '' if it is unknown.
    """

    path: Path
    name: str = ""


@dataclass(frozen=True)
class Attempt:
    """One attempt of a student or a group.

    Attributes:
        whose: a key, the same in all attempts of a student or of a group.
        people: the student, or the members as far as the export contains them.
        pieces: one file or folder, or several files that are one submission.
        number: counts from 1; 0 if the export does not contain it.
        at: when it was handed in, with its time zone.
        problem: why there is nothing to grade.
        keys: what may be the student's id in a roster, the best first; (): those of the person.
        is_marked_late: whether the export says that it is late.
        alone: whether a single file in a folder is the submission, and not the folder.
    """

    whose: str
    people: tuple[Person, ...]
    pieces: tuple[Piece, ...] = ()
    number: int = 0
    at: datetime | None = None
    problem: Message = NOTHING
    keys: tuple[str, ...] = ()
    is_marked_late: bool = False
    alone: bool = False


@dataclass(frozen=True)
class Export:
    """What a layout reads from a folder.

    Attributes:
        layout: the name of the layout, as it follows 'Read as '.
        notes: sentences for the teacher.
    """

    layout: Message
    attempts: Sequence[Attempt]
    notes: Sequence[Message] = field(default=())


def items_of(folder: Path) -> list[Item]:
    """Return the items of a folder, sorted by name, without the junk of a system or a browser."""
    with os.scandir(folder) as entries:
        found = [
            Item(Path(entry.path), entry.is_dir(follow_symlinks=False), composed(entry.name))
            for entry in entries
            if not is_junk(entry.name)
        ]
    return sorted(found, key=lambda item: item.name)


def composed(name: str) -> str:
    """Return a name with each letter and its accents as one character."""
    return unicodedata.normalize("NFC", name)


def add_note(notes: list[Message], what: Message, names: Iterable[str | Message]) -> None:
    """Add a note about some `{names}`, if there are any."""
    if every := list(names):
        notes.append(what.given(names=listed(every)))


def person(id: str, name: str = "", columns: Mapping[str, str] | None = None) -> Person:
    """Make a `Person` of untrusted texts: each in one line, without control characters."""
    named = {_clean(title): _clean(value) for title, value in (columns or {}).items()}
    return Person(_clean(id), _clean(name), named)


def _clean(text: str) -> str:
    # one line first: `plain` changes what is at the start of a line
    return shown(composed(one_line(text)), _MAX_NAME)


def read_time(text: str) -> datetime | None:
    """Parse a time; None if the text is none.

    Without a zone it is this machine's local time, and without an hour the start of the day.
    """
    text = text.strip()
    if _EPOCH.fullmatch(text):
        return datetime.fromtimestamp(int(text[:10]), UTC)
    match = _TIME.fullmatch(text)
    if match is None:
        return _of_moodle(text)
    written = _ISO.format(**match.groupdict("00")).replace("UTC", "Z")
    try:
        at = datetime.fromisoformat(written)
        return at if at.tzinfo else at.astimezone()
    except (ValueError, OverflowError, OSError):  # there is no such day, or zone
        return None


def moment(at: datetime | None) -> float:
    """Return a time for comparison [s]; minus infinity where it is unknown."""
    return at.timestamp() if at else float("-inf")


def _of_moodle(text: str) -> datetime | None:
    """Parse Moodle's format, as in: Tuesday, 1 December 2026, 6:00 PM."""
    text = re.sub("^[A-Za-z]+, ", "", text)
    for form in _MOODLE:
        with suppress(ValueError, OverflowError, OSError):
            return datetime.strptime(text, form).astimezone()
    return None
