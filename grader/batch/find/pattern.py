"""How names are made, as a caller says it: `{id}_{name}_{attempt}`, `{id}/{at}`.

A field in braces takes at least one character, and as few as it can; the last takes the rest. All
else stands for itself. A slash is one between folders. `{id}`, `{name}` and `{email}` say whose it
is, one of them at least; `{attempt}` is a number, `{at}` a time (`times.py`), `{filename}` what it
was called when it was handed in, and `{}` whatever. Any other name makes a column of its own. The
ending of a file need not be said: `{id}` fits alice.py and alice.tar.gz, and means alice.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Final

from grader.batch.find.attempt import Attempt, Item, Piece, Reading, items_of, person
from grader.batch.find.plain import stem
from grader.batch.find.times import read_time
from grader.errors import UsageError
from grader.submission.folder import is_junk, listed, shown

MAX_LEVELS: Final = 4
_WHOSE: Final = ("id", "name", "email")
_FIELD: Final = re.compile(r"\{([^{}]*)\}")
_WORD: Final = re.compile(r"[^\W\d]\w*")
_SHAPES: Final = {"attempt": r"\d{1,6}"}
_ADVICE: Final = "Write it like {id}_{name}_{attempt}: see docs/batch.md."


class Pattern:
    """A pattern, understood.

    Raises:
        UsageError: it makes no sense; the text says why.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self.levels = text.count("/") + 1
        self.fields: list[str] = []
        parts = []
        at, ended = 0, -1
        for match in _FIELD.finditer(text):
            if match.start() == ended:
                raise self._refused("two fields follow each other, with nothing between them")
            parts += [self._literal(text[at : match.start()]), self._field(match[1])]
            at = ended = match.end()
        parts.append(self._literal(text[at:]))
        if not set(_WHOSE) & set(self.fields):
            raise self._refused("it does not say whose a file is: one of {id}, {name}, {email}")
        if self.levels > MAX_LEVELS or "" in text.split("/"):
            raise self._refused(f"it has empty folders, or more than {MAX_LEVELS}")
        self._regex = re.compile("".join(parts), re.DOTALL)

    def fields_of(self, path: Sequence[Item]) -> dict[str, str] | None:
        """What a name says, with the folders above it; None if it does not fit."""
        folders = [item.name for item in path[:-1]]
        names = [path[-1].name] if "filename" in self.fields else [stem(path[-1]), path[-1].name]
        for name in names:
            if match := self._regex.fullmatch("/".join((*folders, name))):
                return match.groupdict()
        return None

    def read(self, items: Sequence[Item]) -> Reading:
        """The hand-ins in a folder.

        Raises:
            UsageError: nothing fits.
        """
        attempts, others, notes = [], [], list[str]()
        for path in self._paths(items, ()):
            said = self.fields_of(path)
            if said is None or is_junk(said.get("filename") or "a"):
                others.append("/".join(item.name for item in path))
            else:
                attempts.append(_attempt(path[-1], said, notes))
        if not attempts:
            found = listed(others, 5) or "nothing that deep"
            raise UsageError(
                f"--pattern {shown(self.text)} fits none of what was found: {found}. {_ADVICE}"
            )
        if others:
            notes.append(f"Left out, since the pattern does not fit: {listed(others)}.")
        return Reading(f"the pattern {shown(self.text)} says", attempts, notes)

    def _paths(self, items: Sequence[Item], above: tuple[Item, ...]) -> Iterator[tuple[Item, ...]]:
        for item in items:
            path = (*above, item)
            if len(path) == self.levels:
                yield path
            elif item.is_folder and not item.path.is_symlink():
                yield from self._paths(items_of(item.path), path)

    def _literal(self, text: str) -> str:
        if "{" in text or "}" in text:
            raise self._refused("a brace has no partner")
        return re.escape(text)

    def _field(self, name: str) -> str:
        if not name:
            return "[^/]+?"
        if not _WORD.fullmatch(name):
            raise self._refused(f"{{{shown(name)}}} is no name for a field: expected one word")
        if name in self.fields:
            raise self._refused(f"{{{shown(name)}}} stands in it twice")
        self.fields.append(name)
        return f"(?P<{name}>{_SHAPES.get(name, '[^/]+?')})"

    def _refused(self, why: str) -> UsageError:
        return UsageError(f"--pattern {shown(self.text)}: {why}. {_ADVICE}")


def _attempt(item: Item, said: dict[str, str], notes: list[str]) -> Attempt:
    id, name, email = (said.pop(field, "").strip() for field in _WHOSE)
    filename = said.pop("filename", "")
    number = int(said.pop("attempt", "0"))
    at = None
    if text := said.pop("at", ""):
        at = read_time(text)
        if at is None:
            notes.append(f"{shown(item.name)}: {shown(text)} is no time such as 2026-11-01T12:30Z.")
    columns = {title: text.strip() for title, text in said.items()}
    if email:
        columns["email"] = email
    whose = person(id or email or name, name, columns)
    original = filename or ("" if item.is_folder else item.name)
    return Attempt(whose.id, (whose,), (Piece(item.path, original),), number, at)
