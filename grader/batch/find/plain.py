"""A folder whose names say whose a hand-in is: `alice.py`, `bob/`; or names as a pattern says.

A pattern is what a caller says of how names are made: `{id}_{name}_{attempt}`, `{id}/{at}`. A field
in braces takes at least one character, and as few as it can; the last takes the rest. All else
stands for itself. A slash is one between folders. `{id}`, `{name}` and `{email}` say whose it is,
one of them at least; `{attempt}` is a number, `{at}` a time (`attempt.read_time`), `{filename}`
what it was called when it was handed in, and `{}` whatever. Any other name makes a column of its
own. The ending of a file need not be said: `{id}` fits alice.py and alice.tar.gz, and means alice.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache
from typing import Final

from grader.batch.find.attempt import (
    Attempt,
    Export,
    Item,
    Piece,
    items_of,
    person,
    read_time,
    tell,
)
from grader.errors import UsageError
from grader.message import Message, msg
from grader.submission.folder import is_junk, listed, shown
from grader.submission.unpacking import is_archive

LAYOUT: Final = msg("a plain folder, with one file or folder a student")
#: What lies beside hand-ins and is none.
_OTHERS: Final = (".csv", ".json", ".md", ".ods", ".txt", ".xls", ".xlsx", ".yaml", ".yml", ".html")
#: With any of these at its top a folder is a package.
_PACKAGE: Final = ("setup.py", "setup.cfg", "pyproject.toml", "package.xml", "CMakeLists.txt")
#: Folders of a colcon workspace.
_WORKSPACE: Final = {"src", "build", "install", "log"}
MAX_LEVELS: Final = 4
_MAX_DIGITS: Final = 9  # of the number of an attempt
_WHOSE: Final = ("id", "name", "email")
_FIELD: Final = re.compile(r"\{([^{}]*)\}")
_WORD: Final = re.compile(r"[^\W\d]\w*")
_ADVICE: Final = msg("Write it like {{id}}_{{name}}_{{attempt}}: see docs/batch.md.")


def one_submission(items: Sequence[Item]) -> str:
    """What says that a folder is itself one submission; '' if nothing does."""
    names = {item.name for item in items}
    if found := [name for name in _PACKAGE if name in names]:
        return found[0]
    folders = {item.name for item in items if item.is_folder}
    return "src" if "src" in folders and folders <= _WORKSPACE else ""


def read(items: Sequence[Item]) -> Export:
    """The hand-ins in one."""
    own = [item for item in items if _may_be_one(item)]
    others = [item.name for item in items if not _may_be_one(item)]
    # of alice.py and alice.zip the first of this order is taken, and the other told
    own.sort(key=lambda item: (not item.is_folder, not is_archive(item.path)))
    notes, whose = [], dict[str, Item]()
    for item in own:
        name = stem(item)
        if name in whose:
            notes.append(
                msg(
                    "{file} is left out: {other} is of the same name.",
                    file=shown(item.name),
                    other=shown(whose[name].name),
                )
            )
        else:
            whose[name] = item
    attempts = [
        Attempt(name, (person(name),), (Piece(item.path, "" if item.is_folder else item.name),))
        for name, item in sorted(whose.items())
    ]
    tell(notes, msg("Left out, since they are no submissions: {names}."), others)
    return Export(LAYOUT, attempts, notes)


def stem(item: Item) -> str:
    """A name without the ending that says what kind of file it is."""
    if item.is_folder:
        return item.name
    name = re.sub(r"\.tar\.gz$", ".tgz", item.name, flags=re.IGNORECASE)
    return name.rpartition(".")[0] or name


def _may_be_one(item: Item) -> bool:
    return item.is_folder or not item.name.lower().endswith(_OTHERS)


class _Field(str):
    """A field's name, among the parts of a pattern; the others stand for themselves."""


class Pattern:
    """A pattern, understood.

    Raises:
        UsageError: it makes no sense; the text says why.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        self.levels = text.count("/") + 1
        self._parts: list[str] = []
        at = 0
        for match in _FIELD.finditer(text):
            if match.start() == at and self._parts:
                raise self._refused(msg("two fields follow each other, with nothing between them"))
            self._parts += [self._literal(text[at : match.start()]), self._field(match[1])]
            at = match.end()
        self._parts.append(self._literal(text[at:]))
        if not set(_WHOSE) & self._fields:
            raise self._refused(
                msg("it does not say whose a file is: one of {{id}}, {{name}}, {{email}}")
            )
        if self.levels > MAX_LEVELS or "" in text.split("/"):
            raise self._refused(msg("it has empty folders, or more than {most}", most=MAX_LEVELS))

    @property
    def _fields(self) -> set[str]:
        return {str(part) for part in self._parts if isinstance(part, _Field)}

    def fields_of(self, path: Sequence[Item]) -> dict[str, str] | None:
        """What a name says, with the folders above it; None if it does not fit."""
        folders = [item.name for item in path[:-1]]
        names = [path[-1].name] if "filename" in self._fields else [stem(path[-1]), path[-1].name]
        for name in names:
            said = self._fitted("/".join((*folders, name)))
            if said is not None:
                return {field: text for field, text in said if field}
        return None

    def _fitted(self, text: str) -> list[tuple[str, str]] | None:
        """The fields in a text.

        A regular expression would do, but for names that are made to keep it busy: here each part
        is tried at each place once.
        """

        @cache
        def rest(number: int, at: int) -> list[tuple[str, str]] | None:
            if number == len(self._parts):
                return [] if at == len(text) else None
            part = self._parts[number]
            if not isinstance(part, _Field):
                fits = text.startswith(part, at)
                return rest(number + 1, at + len(part)) if fits else None
            for end in range(at + 1, len(text) + 1):
                last = text[end - 1]
                if last == "/" or (part == "attempt" and last not in "0123456789"):
                    break
                if (said := rest(number + 1, end)) is not None:
                    return [(str(part), text[at:end]), *said]
            return None

        return rest(0, 0)

    def read(self, items: Sequence[Item]) -> Export:
        """The hand-ins in a folder.

        Raises:
            UsageError: nothing fits.
        """
        attempts, others, notes = list[Attempt](), list[str](), list[Message]()
        for path in self._paths(items, ()):
            said = self.fields_of(path)
            if said is None or is_junk(said.get("filename") or "a"):
                others.append("/".join(item.name for item in path))
            else:
                attempts.append(_attempt(path[-1], said, notes))
        if not attempts:
            raise UsageError(
                "--pattern {pattern} fits none of what was found: {found}. {advice}",
                pattern=shown(self.text),
                found=listed(others, 5) or msg("nothing that deep"),
                advice=_ADVICE,
            )
        if "filename" in self._fields:
            attempts = _together(attempts)
        tell(notes, msg("Left out, since the pattern does not fit: {names}."), others)
        layout = msg("the pattern {pattern} says", pattern=shown(self.text))
        return Export(layout, attempts, notes)

    def _paths(self, items: Sequence[Item], above: tuple[Item, ...]) -> Iterator[tuple[Item, ...]]:
        for item in items:
            path = (*above, item)
            if len(path) == self.levels:
                yield path
            elif item.is_folder and not item.path.is_symlink():
                yield from self._paths(items_of(item.path), path)

    def _literal(self, text: str) -> str:
        if "{" in text or "}" in text:
            raise self._refused(msg("a brace has no partner"))
        return text

    def _field(self, name: str) -> _Field:
        if not name:
            return _Field()
        if not _WORD.fullmatch(name):
            raise self._refused(
                msg("{field} is no name for a field: expected one word", field=_braced(name))
            )
        if name in self._fields:
            raise self._refused(msg("{field} stands in it twice", field=_braced(name)))
        return _Field(name)

    def _refused(self, why: Message) -> UsageError:
        return UsageError(
            "--pattern {pattern}: {why}. {advice}",
            pattern=shown(self.text),
            why=why,
            advice=_ADVICE,
        )


def _braced(name: str) -> str:
    return f"{{{shown(name)}}}"


def _together(attempts: Sequence[Attempt]) -> list[Attempt]:
    """The same, with all files that were handed in at once as one attempt."""
    found: dict[object, Attempt] = {}
    for each in attempts:
        same = (each.whose, each.number, each.at)
        before = found.get(same)
        found[same] = replace(before, pieces=before.pieces + each.pieces) if before else each
    return list(found.values())


def _attempt(item: Item, said: dict[str, str], notes: list[Message]) -> Attempt:
    id, name, email = (said.pop(field, "").strip() for field in _WHOSE)
    filename = said.pop("filename", "")
    number = int(said.pop("attempt", "0")[-_MAX_DIGITS:])
    at = None
    if text := said.pop("at", ""):
        at = read_time(text)
        if at is None:
            notes.append(
                msg(
                    "{file}: {text} is no time such as 2026-11-01T12:30Z.",
                    file=shown(item.name),
                    text=shown(text),
                )
            )
    columns = {title: text.strip() for title, text in said.items()}
    if email:
        columns["email"] = email
    whose = person(id or email or name, name, columns)
    original = filename or ("" if item.is_folder else item.name)
    return Attempt(whose.id, (whose,), (Piece(item.path, original),), number, at)
