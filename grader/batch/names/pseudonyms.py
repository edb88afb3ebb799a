"""Students under pseudonyms: `grader batch SUBMISSIONS --out DIR --pseudonyms KEY`.

A pseudonym is made of a student's id and of a key that lies outside of the class's folder: the same
key gives the same student the same one every week, and without the key nobody can compute it, not
even from a list of all students.
"""

from __future__ import annotations

import hashlib
import hmac
import json
import os
import secrets
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Final

from grader import files
from grader.batch.entry import Entry, HandIn, Person, id_of
from grader.batch.names.people import forms, names_of, of_all
from grader.batch.names.replacing import Names
from grader.batch.names.spelling import composed
from grader.errors import UsageError
from grader.message import msg

#: What each pseudonym begins with; alone it stands for a name that several have.
STUDENT: Final = "student"
_DIGITS: Final = 10  # two of 20,000 students have the same one in one of 5,000 courses
_KEY_BYTES: Final = 32
_SHORTEST_KEY: Final = 32  # characters


@dataclass(frozen=True)
class Known:
    """The names of a class, for the runs and the pages.

    Attributes:
        everybody: the forms of all names -> what stands for them.
        own: the id of a hand-in -> the forms of its own people's names.
    """

    everybody: Mapping[str, str] = field(default_factory=dict)
    own: Mapping[str, Mapping[str, str]] = field(default_factory=dict)


class Pseudonyms:
    """Gives students their pseudonyms.

    Args:
        key: a secret.
    """

    def __init__(self, key: bytes) -> None:
        self._key = key

    @property
    def mark(self) -> str:
        """Shows in class.json which key it was."""
        return self._digest("class")[:_DIGITS]

    @property
    def run_secret(self) -> str:
        """Goes into the keys of runs: names of files are hashed into these."""
        return self._digest("runs")

    def of(self, id: str) -> str:
        """Return the pseudonym of the student with this id."""
        return f"{STUDENT}{self._digest(f'student {composed(id)}')[:_DIGITS]}"

    def of_hand_ins(self, found: Sequence[HandIn]) -> dict[str, HandIn]:
        """Return the hand-ins under pseudonyms, sorted; new id -> the hand-in as it was.

        Raises:
            UsageError: two students have the same pseudonym.
        """
        self._check_different(found)
        named: dict[str, HandIn] = {}
        for hand_in in found:
            id = id_of(sorted(self.of(person.id) for person in hand_in.people))
            if id in named:  # an unknown person may have the id of a member of the roster
                id = f"{id}-{self._digest(f'hand-in {hand_in.id}')[:4]}"
            named[id] = hand_in
        return dict(sorted(named.items()))

    def hand_in(self, id: str, was: HandIn, names: Names) -> HandIn:
        """Return a hand-in under its new id, without names."""
        people = tuple(Person(self.of(person.id)) for person in was.people)
        return replace(was, id=id, people=people, filename="", problem=was.problem.map_texts(names))

    def known(self, named: Mapping[str, HandIn], words: frozenset[str]) -> Known:
        """Return the names of a class.

        Args:
            named: from `of_hand_ins`.
            words: that do not count by themselves; see `people.known_words`.
        """
        people = {
            self.of(person.id): names_of(person)
            for hand_in in named.values()
            for person in hand_in.people
        }
        own = {}
        for id, hand_in in named.items():
            own[id] = {
                name: stands
                for person in hand_in.people
                for name, stands in forms(names_of(person), self.of(person.id), words).items()
            }
        return Known(of_all(people, words, STUDENT), own)

    def _digest(self, text: str) -> str:
        return hmac.new(
            self._key, text.encode("utf-8", "surrogatepass"), hashlib.sha256
        ).hexdigest()

    def _check_different(self, found: Sequence[HandIn]) -> None:
        whose: dict[str, str] = {}
        for person in (person for hand_in in found for person in hand_in.people):
            same = composed(person.id)
            if whose.setdefault(self.of(person.id), same) != same:
                raise UsageError(
                    msg("two students have the same pseudonym by this key: take another one")
                )


def put(known: Known, folder: Path) -> Path:
    """Write the names of a class into a file for workers; return its path.

    Raises:
        UsageError: it cannot be written.
    """
    path = folder / "names.json"
    files.put(path, json.dumps(dict(known.everybody)).encode())
    return path


def read(path: Path) -> Names:
    """Read a file that `put` has written.

    Raises:
        OSError: it cannot be read.
    """
    return _names(path.read_bytes())


@lru_cache(maxsize=1)  # a worker needs them for each task, and those of 20,000 take seconds
def _names(data: bytes) -> Names:
    return Names(json.loads(data))


def read_key(path: Path, folders: Iterable[Path], *, may_make: bool) -> bytes:
    """Read a key; make one where there is none.

    Args:
        folders: it must not be in or below these: the class's, and the submissions'.
        may_make: whether a new one may be made: a class that was begun has one.

    Raises:
        UsageError: it cannot be read or written, is too short, or lies where others find it.
    """
    check_outside(path, folders, msg("the key"))
    if not os.path.lexists(path):
        if not may_make:
            raise UsageError(
                "there is no key {path}, and this class was begun with one: give that one",
                path=str(path),
            )
        _make(path)
    try:
        text = path.read_text(encoding="ascii").strip()
        mode = path.stat().st_mode
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError("cannot read {path}: {why}", path=str(path), why=str(error)) from None
    if len(text) < _SHORTEST_KEY:
        raise UsageError(
            "{path} is no key: expected {least} characters or more that nobody guesses, found "
            "{found}. Name a file that is not there, and a key is made.",
            path=str(path),
            least=_SHORTEST_KEY,
            found=len(text),
        )
    if os.name == "posix" and mode & 0o077:
        raise UsageError(
            "{path} can be read by others of this machine: chmod 600 {path}", path=str(path)
        )
    return text.encode()


def check_outside(path: Path, folders: Iterable[Path], what: object) -> None:
    """Refuse a path in or below folders.

    Raises:
        UsageError: it is.
    """
    for folder in folders:
        whole = folder.resolve()
        lies = (path.resolve(), path.parent.resolve() / path.name)
        if any(each.is_relative_to(whole) for each in lies):
            raise UsageError(
                "{path} lies in {folder}: {what} must lie outside of it, where those who get the "
                "class's folder do not. Nothing was changed.",
                path=str(path),
                folder=str(folder),
                what=what,
            )


def _make(path: Path) -> None:
    files.make_folder(path.parent)
    with files.writing(path):
        made = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with os.fdopen(made, "w", encoding="ascii") as file:
            file.write(f"{secrets.token_hex(_KEY_BYTES)}\n")


def with_names(entries: Iterable[Entry], named: Mapping[str, HandIn]) -> list[Entry]:
    """Return the entries of a class with the names of the people, for imports into a course system.

    Those whose hand-in is not among the submissions any more are left out.
    """
    return [
        replace(entry, hand_in=replace(named[entry.id], path=None, problem=entry.hand_in.problem))
        for entry in entries
        if entry.id in named
    ]
