"""Read a plain folder, with the ids in its names: `alice.py`, `bob/`; or names by a pattern.

A pattern describes the names: `{id}_{name}_{attempt}`, `{id}/{at}`. A field in braces matches at
least one character, and as few as possible; the last matches the rest. Everything else is literal.
A slash separates folders. `{id}`, `{name}` and `{email}` identify the student, one of them at
least; `{attempt}` is a number, `{at}` a time (`attempt.read_time`), `{filename}` the original name,
and `{}` anything. Any other name becomes a column. The suffix of a file may be left out: `{id}`
matches alice.py and alice.tar.gz, both as alice.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache
from typing import Final

from grader import UsageError
from grader.submission import is_archive, is_junk
from grader.text import NOTHING, Message, listed, msg, shown
from grader_class.find.attempt import (
    Attempt,
    Export,
    Item,
    Piece,
    add_note,
    items_of,
    person,
    read_time,
)

LAYOUT: Final = msg("a plain folder, with one file or folder a student")
#: Suffixes of files beside hand-ins that are none.
_OTHERS: Final = (".csv", ".json", ".md", ".ods", ".txt", ".xls", ".xlsx", ".yaml", ".yml", ".html")
#: With any of these at its top a folder is a package.
_PACKAGE: Final = ("setup.py", "setup.cfg", "pyproject.toml", "package.xml", "CMakeLists.txt")
#: Folders of a colcon workspace.
_WORKSPACE: Final = {"src", "build", "install", "log"}
_MAX_DIGITS: Final = 9  # of the number of an attempt
_WHOSE: Final = ("id", "name", "email")
_FIELD: Final = re.compile(r"\{([^{}]*)\}")
_WORD: Final = re.compile(r"[^\W\d]\w*")
_ADVICE: Final = msg("Write it like {{id}}_{{name}}_{{attempt}}: see docs/batch.md.")


def one_submission(items: Sequence[Item]) -> str:
    """Return the name that shows that a folder is itself one submission; '' if none does."""
    names = {item.name for item in items}
    if found := [name for name in _PACKAGE if name in names]:
        return found[0]
    folders = {item.name for item in items if item.is_folder}
    return "src" if "src" in folders and folders <= _WORKSPACE else ""


def read(items: Sequence[Item]) -> Export:
    """Read the attempts in a folder."""
    possible = [item for item in items if _may_be_one(item)]
    others = [item.name for item in items if not _may_be_one(item)]
    # of alice.py and alice.zip the first in this order is graded, and the other reported
    possible.sort(key=lambda item: (not item.is_folder, not is_archive(item.path)))
    whose: dict[str, Item] = {}
    for item in possible:
        whose.setdefault(stem(item), item)
    doubles = [item.name for item in possible if whose[stem(item)] is not item]
    attempts = [
        Attempt(name, (person(name),), (Piece(item.path, "" if item.is_folder else item.name),))
        for name, item in sorted(whose.items())
    ]
    notes: list[Message] = []
    add_note(notes, msg("Left out, since a folder or archive has the same name: {names}."), doubles)
    add_note(notes, msg("Left out, since they are no submissions: {names}."), others)
    return Export(LAYOUT, attempts, notes)


def stem(item: Item) -> str:
    """Return a name without its suffix."""
    if item.is_folder:
        return item.name
    name = re.sub(r"\.tar\.gz$", ".tgz", item.name, flags=re.IGNORECASE)
    return name.rpartition(".")[0] or name


def _may_be_one(item: Item) -> bool:
    return item.is_folder or not item.name.lower().endswith(_OTHERS)


class Pattern:
    """A parsed pattern.

    Raises:
        UsageError: the pattern is not valid.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self.levels = text.count("/") + 1
        #: literal texts, and at odd places the names of fields between them
        self._parts = _FIELD.split(text)
        literals, self._fields = self._parts[::2], list(filter(None, self._parts[1::2]))
        if why := _fault(literals, self._fields):
            raise UsageError(
                "--pattern {pattern}: {why}. {advice}",
                pattern=shown(text),
                why=why,
                advice=_ADVICE,
            )

    def fields_of(self, path: Sequence[Item]) -> dict[str, str] | None:
        """Return the fields of a name with the folders above it; None if it does not match."""
        folders = [item.name for item in path[:-1]]
        names = [path[-1].name] if "filename" in self._fields else [stem(path[-1]), path[-1].name]
        for name in names:
            found = self._match("/".join((*folders, name)))
            if found is not None:
                return {field: text for field, text in found if field}
        return None

    def _match(self, text: str) -> list[tuple[str, str]] | None:
        """Return the fields in a text; None if it does not match.

        A regular expression could be kept busy by names made for that: here each part is tried at
        each place once.
        """

        @cache
        def rest(number: int, at: int) -> list[tuple[str, str]] | None:
            if number == len(self._parts):
                return [] if at == len(text) else None
            part = self._parts[number]
            if number % 2 == 0:
                fits = text.startswith(part, at)
                return rest(number + 1, at + len(part)) if fits else None
            for end in range(at + 1, len(text) + 1):
                last = text[end - 1]
                if last == "/" or (part == "attempt" and last not in "0123456789"):
                    break
                if (found := rest(number + 1, end)) is not None:
                    return [(part, text[at:end]), *found]
            return None

        return rest(0, 0)

    def read(self, items: Sequence[Item]) -> Export:
        """Read the attempts in a folder."""
        attempts, others, notes = list[Attempt](), list[str](), list[Message]()
        for path in self._paths(items, ()):
            fields = self.fields_of(path)
            if fields is None or is_junk(fields.get("filename") or "a"):
                others.append("/".join(item.name for item in path))
            else:
                attempts.append(_attempt(path[-1], fields, notes))
        if not attempts:
            raise UsageError(
                "--pattern {pattern} fits none of what was found: {found}. {advice}",
                pattern=shown(self.text),
                found=listed(others, 5) or msg("nothing that deep"),
                advice=_ADVICE,
            )
        if "filename" in self._fields:
            attempts = _together(attempts)
        add_note(notes, msg("Left out, since the pattern does not fit: {names}."), others)
        layout = msg("the pattern {pattern} says", pattern=shown(self.text))
        return Export(layout, attempts, notes)

    def _paths(self, items: Sequence[Item], above: tuple[Item, ...]) -> Iterator[tuple[Item, ...]]:
        for item in items:
            path = (*above, item)
            if len(path) == self.levels:
                yield path
            elif item.is_folder and not item.path.is_symlink():
                yield from self._paths(items_of(item.path), path)


def _fault(literals: Sequence[str], fields: Sequence[str]) -> Message:
    """Return what is wrong with a pattern; '' where nothing is."""
    if any(sign in literal for literal in literals for sign in "{}"):
        return msg("a brace has no partner")
    if "" in literals[1:-1]:
        return msg("two fields follow each other, with nothing between them")
    for name in fields:
        field = f"{{{shown(name)}}}"
        if not _WORD.fullmatch(name):
            return msg("{field} is no name for a field: expected one word", field=field)
        if fields.count(name) > 1:
            return msg("{field} stands in it twice", field=field)
    if not set(_WHOSE) & set(fields):
        return msg("it does not say whose a file is: one of {{id}}, {{name}}, {{email}}")
    if "" in "*".join(literals).split("/"):
        return msg("it has empty folders")
    return NOTHING


def _together(attempts: Sequence[Attempt]) -> list[Attempt]:
    """Merge the files of one attempt."""
    found: dict[object, Attempt] = {}
    for each in attempts:
        same = (each.whose, each.number, each.at)
        before = found.get(same)
        found[same] = replace(before, pieces=before.pieces + each.pieces) if before else each
    return list(found.values())


def _attempt(item: Item, fields: dict[str, str], notes: list[Message]) -> Attempt:
    id, name, email = (fields.pop(field, "").strip() for field in _WHOSE)
    filename = fields.pop("filename", "")
    number = int(fields.pop("attempt", "0")[-_MAX_DIGITS:])
    at = None
    if text := fields.pop("at", ""):
        at = read_time(text)
        if at is None:
            notes.append(
                msg(
                    "{file}: {text} is no time such as 2026-11-01T12:30Z.",
                    file=shown(item.name),
                    text=shown(text),
                )
            )
    columns = {title: text.strip() for title, text in fields.items()}
    if email:
        columns["email"] = email
    whose = person(id or email or name, name, columns)
    original = filename or ("" if item.is_folder else item.name)
    return Attempt(whose.id, (whose,), (Piece(item.path, original),), number, at)
