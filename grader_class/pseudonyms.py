"""Students under pseudonyms: `grader batch SUBMISSIONS --out DIR --pseudonyms KEY`.

A pseudonym is the HMAC-SHA256 of a student's id with the secret in the file KEY: it is the same
every week, and without the key nobody can compute it, not even from a list of all students. It
stands where the grader would name the student; what a hand-in itself says is not touched.
"""

from __future__ import annotations

import hashlib
import hmac
import os
import re
import secrets
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

from grader import UsageError
from grader.system import files
from grader.text import Message, msg
from grader_class.class_file import CLASS, ClassFile
from grader_class.entry import HandIn, Person, comparable, id_of

_DIGITS: Final = 12  # two of 20,000 students have the same ones in one of a million courses
_SHORTEST_KEY: Final = 32  # characters
#: The name of a hand-in whose own would name the student; and the end that tells a file's kind.
_NEUTRAL, _SUFFIX = "submission", re.compile(r"(?:\.tar|\.launch)?\.[^.]+$|$")


@dataclass(frozen=True)
class Pseudonyms:
    """Gives students their pseudonyms."""

    key: bytes = field(repr=False)

    @property
    def mark(self) -> str:
        """Shows in class.json which key it was."""
        return self._digest("class")

    def of(self, id: str) -> str:
        """Return the pseudonym of the student with this id."""
        return f"student{self._digest(f'student {comparable(id)}')}"

    def hide(self, hand_ins: Iterable[HandIn]) -> dict[str, tuple[HandIn, HandIn]]:
        """Return id -> the hand-in without names, and with; sorted, so that order tells nothing."""
        hidden: dict[str, tuple[HandIn, HandIn]] = {}
        for each in hand_ins:
            people = tuple(Person(self.of(person.id)) for person in each.people)
            id = id_of(sorted(person.id for person in people))
            if id in hidden:  # an unknown person may have the id of a member of the roster
                id = f"{id}-{self._digest(f'hand-in {each.id}')[:4]}"
            hidden[id] = replace(each, id=id, people=people, filename=_filename(each)), each
        return dict(sorted(hidden.items()))

    def _digest(self, text: str) -> str:
        data = text.encode("utf-8", "surrogatepass")
        return hmac.new(self.key, data, hashlib.sha256).hexdigest()[:_DIGITS]


def _filename(hand_in: HandIn) -> str:
    """Return the name to grade a hand-in by: that of a folder is the export's, and not its own."""
    if hand_in.path is None or hand_in.path.is_dir():
        return _NEUTRAL
    name = hand_in.filename or hand_in.path.name
    suffix = "".join(_SUFFIX.findall(name))
    whole, stem = comparable(name), comparable(name.removesuffix(suffix))
    cells = {cell for person in hand_in.people for cell in person.columns.values()}
    whose = {text for person in hand_in.people for text in (person.id, person.name)} - {""}
    is_theirs = stem in map(comparable, cells) or any(comparable(text) in whole for text in whose)
    return f"{_NEUTRAL}{suffix}" if is_theirs else name


def of_class(key: Path, out: Path, submissions: Path, names: Path | None) -> Pseudonyms:
    """Return the pseudonyms of a class by the file with the key, which is made for a new class."""
    if names is not None:
        _check_outside(names, (out, submissions), msg("what has names"))
    _check_outside(key, (out, submissions), msg("the key"))
    is_begun = (out / CLASS).is_file()
    if is_begun and not ClassFile.read(out).pseudonyms:
        raise UsageError(
            "{out} was begun with names. Give another --out. Nothing was changed.", out=out
        )
    if not is_begun and not os.path.lexists(key):
        files.make_folder(key.parent)
        with files.writing(key):
            key.touch(0o600, exist_ok=False)
            key.write_text(f"{secrets.token_hex()}\n", "ascii")
    return Pseudonyms(_read_key(key))


def _check_outside(path: Path, folders: Sequence[Path], what: Message) -> None:
    """Refuse a path in or below a class or these folders, or that is a link there."""
    ours = {folder.resolve() for folder in folders}
    for lies in (path.resolve(), path.parent.resolve() / path.name):
        for at in (lies, *lies.parents):
            if at in ours or (at / CLASS).is_file():
                raise UsageError(
                    "{path} lies in {folder}: {what} must lie outside of it, where those who get "
                    "the class's folder do not. Nothing was changed.",
                    path=path,
                    folder=at,
                    what=what,
                )


def _read_key(path: Path) -> bytes:
    try:
        text, mode = path.read_text("ascii").strip(), path.stat().st_mode
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError("cannot read {path}: {why}", path=path, why=str(error)) from None
    if len(text) < _SHORTEST_KEY:
        raise UsageError(
            "{path} is no key: expected {least} characters or more that nobody guesses, found "
            "{found}. Name a file that is not there, and a key is made.",
            path=path,
            least=_SHORTEST_KEY,
            found=len(text),
        )
    if mode & 0o077:
        raise UsageError(
            "{path} can be read by others of this machine: chmod 600 {path}", path=path
        )
    return text.encode()
