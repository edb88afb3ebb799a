"""What reading an export comes to, whatever its layout: attempts, each somebody's at a time."""

from __future__ import annotations

import os
import re
import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path
from typing import Final, Protocol

from grader.batch.entry import Person
from grader.message import NOTHING, Message, Text
from grader.submission.folder import is_junk, listed
from grader.text import clip, one_line, plain

_MAX_NAME = 200  # characters of a person's name or id
_MAX_NAME_BYTES: Final = 200  # of a file's name; file systems take 255
#: ISO 8601, and what is made of it for names of files: 2026-11-01_12-30-05, 20261101T123005Z;
#: Ruby's YAML has nanoseconds and a space before the zone.
_TIME: Final = re.compile(
    r"(?P<year>\d{4})-?(?P<month>\d\d)-?(?P<day>\d\d)"
    r"(?:(?:T|[ _-]+|, )(?P<hour>\d\d)[:.h-]?(?P<minute>\d\d)"
    r"(?:[:.-]?(?P<second>\d\d)(?:[.,](?P<fraction>\d{1,9}))?)?)?"
    r" ?(?:(?P<utc>Z|UTC)|(?P<sign>[+-])(?P<hours>\d\d):?(?P<minutes>\d\d))?"
)
#: As Moodle writes it in English, but for the day of the week before it.
_MOODLE: Final = ("%d %B %Y, %I:%M %p", "%d %B %Y, %H:%M")
_EPOCH: Final = re.compile(r"\d{10}|\d{13}")  # seconds, milliseconds since 1970


@dataclass(frozen=True)
class Item:
    """What lies directly in the folder of a class.

    Attributes:
        is_folder: itself, and no link to one.
        name: as it stands there, composed (NFC): macOS takes letters and their accents apart.
    """

    path: Path
    is_folder: bool
    name: str


@dataclass(frozen=True)
class Piece:
    """A file or a folder that was handed in.

    Attributes:
        name: what it was called before the export gave it another name; '' if nobody knows.
    """

    path: Path
    name: str = ""


@dataclass(frozen=True)
class Attempt:
    """What somebody handed in at once.

    Attributes:
        whose: the same in all attempts of a student, or of a group.
        people: of it; as far as the export tells.
        pieces: one file or folder, or several files that are one submission.
        number: counts from 1; 0 if the export does not tell.
        at: when, with its time zone.
        problem: why there is nothing to grade.
        aliases: what else their id may be; which of these, is the same for all of a class.
        alone: the file in a folder that holds nothing else is what was handed in.
    """

    whose: str
    people: tuple[Person, ...]
    pieces: tuple[Piece, ...] = ()
    number: int = 0
    at: datetime | None = None
    problem: Message = NOTHING
    aliases: tuple[str, ...] = ()
    alone: bool = False


@dataclass(frozen=True)
class Export:
    """What a layout makes of a folder.

    Attributes:
        layout: what it was taken for, as what follows 'Read as '.
        notes: sentences for the teacher.
    """

    layout: Message
    attempts: Sequence[Attempt]
    notes: Sequence[Message] = field(default=())


class Layout(Protocol):
    """A module that knows one layout."""

    def looks_like(self, items: Sequence[Item], /) -> bool:
        """Whether what lies in a folder is laid out so."""

    def read(self, items: Sequence[Item], /) -> Export:
        """What it comes to."""


def items_of(folder: Path) -> list[Item]:
    """What lies in a folder, sorted by name, without what a system or a browser has left there.

    Raises:
        OSError: it cannot be read.
    """
    with os.scandir(folder) as entries:
        found = [
            Item(Path(entry.path), entry.is_dir(follow_symlinks=False), composed(entry.name))
            for entry in entries
            if not is_junk(entry.name)
        ]
    return sorted(found, key=lambda item: item.name)


def composed(name: str) -> str:
    """A name with each letter and its accents as one character."""
    return unicodedata.normalize("NFC", name)


def tell(notes: list[Message], what: Message, names: Iterable[Text]) -> None:
    """Add a note on some `{names}`; nothing where there are none."""
    if every := list(names):
        notes.append(what.given(names=listed(every)))


def short(part: str) -> str:
    """A name that is not too long for a file system; the end, which says the kind, stays."""
    if len(os.fsencode(part)) <= _MAX_NAME_BYTES:
        return part
    end = part[-30:]
    begin = part.encode("utf-8", "surrogateescape")[: _MAX_NAME_BYTES - len(os.fsencode(end)) - 3]
    return f"{begin.decode('utf-8', 'ignore')}…{end}"


def mostly(items: Iterable[Item], fits: Callable[[Item], object]) -> bool:
    """Whether at least half of what lies in a folder fits; and there is something."""
    found = [bool(fits(item)) for item in items]
    return bool(found) and 2 * sum(found) >= len(found)


def person(id: str, name: str = "", columns: Mapping[str, str] | None = None) -> Person:
    """Somebody, by what strangers have written: in one line, without control characters."""
    named = {_clean(title): _clean(value) for title, value in (columns or {}).items()}
    return Person(_clean(id), _clean(name), named)


def _clean(text: str) -> str:
    # one line first: `plain` looks for what stands at the start of a line
    return clip(composed(plain(one_line(text))).strip(), _MAX_NAME)


def read_time(text: str) -> datetime | None:
    """The moment that a text means; None if it means none.

    Without a zone it is this machine's local time, and without an hour the day's first moment.
    """
    text = text.strip()
    if _EPOCH.fullmatch(text):
        return datetime.fromtimestamp(int(text[:10]), UTC)
    match = _TIME.fullmatch(text)
    if match is None:
        return _of_moodle(text)
    year, month, day, hour, minute, second = (int(part or 0) for part in match.groups()[:6])
    microsecond = int((match["fraction"] or "").ljust(6, "0")[:6])
    try:
        at = datetime(year, month, day, hour, minute, second, microsecond)
        if match["utc"]:
            return at.replace(tzinfo=UTC)
        if match["sign"]:
            return at.replace(tzinfo=zone(match["sign"], match["hours"], match["minutes"]))
        return at.astimezone()
    except (ValueError, OverflowError, OSError):  # there is no such day, or zone
        return None


def moment(at: datetime | None) -> float:
    """A time for comparison [s]; before all others, where it is not known."""
    return at.timestamp() if at else float("-inf")


def _of_moodle(text: str) -> datetime | None:
    """Such as: Tuesday, 1 December 2026, 6:00 PM."""
    text = re.sub("^[A-Za-z]+, ", "", text)
    for form in _MOODLE:
        with suppress(ValueError, OverflowError, OSError):
            return datetime.strptime(text, form).astimezone()
    return None


def zone(sign: str, hours: str, minutes: str) -> timezone:
    """A time zone from its numbers.

    Raises:
        ValueError: no zone is so far away.
    """
    ahead = timedelta(hours=int(hours), minutes=int(minutes))
    if ahead > timedelta(hours=14):
        raise ValueError(f"no time zone is {hours}:{minutes} from Greenwich")
    return timezone(-ahead if sign == "-" else ahead)
