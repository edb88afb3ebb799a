"""What the reading of an export comes to, whatever its layout: attempts, each of somebody."""

from __future__ import annotations

import os
import unicodedata
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Protocol

from grader.batch.hand_in import Person
from grader.submission.folder import is_junk
from grader.text import clip, one_line, plain

_MAX_NAME = 200  # characters of a person's name or id


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
    problem: str = ""
    aliases: tuple[str, ...] = ()
    alone: bool = False


@dataclass(frozen=True)
class Reading:
    """What a layout makes of a folder.

    Attributes:
        layout: what it was taken for, as what follows 'Read as '.
        notes: sentences for the teacher.
    """

    layout: str
    attempts: Sequence[Attempt]
    notes: Sequence[str] = field(default=())


class Layout(Protocol):
    """A module that knows one layout."""

    def looks_like(self, items: Sequence[Item], /) -> bool:
        """Whether what lies in a folder is laid out so."""

    def read(self, items: Sequence[Item], /) -> Reading:
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
