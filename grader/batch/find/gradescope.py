"""Gradescope's export of submissions: `submission_NUMBER/` folders, and a file that says whose.

`submission_metadata.yml` was written by a Ruby program: its keys begin with colons, and a time may
be an object of Ruby's. It also holds all that autograders have printed of students' programs. So it
is read event by event, nothing but texts are made of it, and all else is passed over.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Final

import yaml

from grader.batch.entry import Person
from grader.batch.find.attempt import Attempt, Export, Item, Piece, mostly, person, read_time, tell
from grader.message import NOTHING, Message, msg, reason
from grader.submission.folder import shown
from grader.text import in_one_line

LAYOUT: Final = msg("Gradescope's export of submissions")
METADATA: Final = "submission_metadata.yml"
MAX_METADATA_BYTES: Final = 200_000_000
_FOLDER: Final = re.compile(r"submission_(?P<number>\d+)")
_NO_FILES: Final = msg("Gradescope's export holds no file of this submission.")
#: Of a submission; nothing else is looked at.
_WANTED: Final = ("submitters", "created_at")
_MAX_DEPTH: Final = 4  # of submissions, submitters, and what is said of one
_MAX_TEXT: Final = 1_000  # characters; what is longer is no name


def looks_like(items: Sequence[Item]) -> bool:
    """Whether a folder is one."""
    if any(item.name == METADATA and item.path.is_file() for item in items):
        return True
    return mostly(items, lambda item: item.is_folder and _FOLDER.fullmatch(item.name))


def read(items: Sequence[Item]) -> Export:
    """The hand-ins in one."""
    notes: list[Message] = []
    lying = {item.name: item for item in items}
    told = _metadata(lying.pop(METADATA, None), notes)
    attempts = [_attempt(name, lying.pop(name, None), said) for name, said in told.items()]
    others = []
    for name, item in lying.items():
        if item.is_folder and _FOLDER.fullmatch(name):
            attempts.append(_attempt(name, item, {}))
        else:
            others.append(name)
    tell(notes, msg("Left out, since Gradescope does not name them so: {names}."), others)
    return Export(LAYOUT, attempts, notes)


def _attempt(name: str, item: Item | None, said: dict[str, Any]) -> Attempt:
    match = _FOLDER.fullmatch(name)
    number = match["number"] if match else name
    people = tuple(_people(said.get("submitters"))) or (person(number),)
    return Attempt(
        "+".join(sorted(each.id for each in people)),
        people,
        () if item is None else (Piece(item.path, "" if item.is_folder else item.name),),
        at=_time(said.get("created_at")),
        problem=_NO_FILES if item is None else NOTHING,
        alone=True,
    )


def _people(said: object) -> Iterator[Person]:
    for each in said if isinstance(said, list) else ():
        if isinstance(each, dict):
            name, sid, email = (_text(each.get(key)) for key in ("name", "sid", "email"))
            if id := sid or email or name:
                yield person(id, name, {"SID": sid, "Email": email})


def _time(said: object) -> Any:
    """A time, or Ruby's object of one, which says it in UTC."""
    return read_time(_text(said.get("utc") if isinstance(said, dict) else said))


def _text(said: object) -> str:
    return said if isinstance(said, str) and said not in ("~", "null") else ""


def _metadata(item: Item | None, notes: list[Message]) -> dict[str, dict[str, Any]]:
    """What is said of each submission, by the name of its folder."""
    why = msg("there is no {file}", file=METADATA)
    if item is not None and item.path.is_file():
        try:
            found = _Texts(item.path).read()
            return {name: said for name, said in found.items() if isinstance(said, dict)}
        except yaml.MarkedYAMLError as error:
            line = error.problem_mark.line + 1 if error.problem_mark else 1
            why = msg(
                "{file} is damaged in line {line} ({what})",
                file=METADATA,
                line=str(line),
                what=shown(error.problem) if error.problem else msg("no YAML"),
            )
        except (yaml.YAMLError, ValueError) as error:
            why = msg(
                "{file} cannot be read ({why})", file=METADATA, why=in_one_line(reason(error))
            )
    notes.append(msg("Names, ids and times are missing, since {why}.", why=why))
    return {}


class _Texts:
    """The texts in a YAML file, as many as are asked for, in dicts and lists.

    No tag is followed and no value made of a text: `sid: 007` stays what it is.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._anchors: dict[str, str] = {}

    def read(self) -> dict[str, Any]:
        """All of it.

        Raises:
            yaml.YAMLError: it is no YAML.
            ValueError: it is too large, or something else than a mapping.
        """
        if self._path.stat().st_size > MAX_METADATA_BYTES:
            raise ValueError(msg("it has more than {size:g} MB", size=MAX_METADATA_BYTES / 1e6))
        loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
        with self._path.open("rb") as file:
            self._events = yaml.parse(file, Loader=loader)
            for event in self._events:
                if isinstance(event, yaml.MappingStartEvent):
                    return dict(self._mapping(0))
        raise ValueError(msg("it is empty"))

    def _value(self, event: Any, depth: int) -> Any:
        if isinstance(event, yaml.ScalarEvent):
            if event.anchor and len(event.value) <= _MAX_TEXT:
                self._anchors[event.anchor] = event.value
            return event.value[:_MAX_TEXT]
        if isinstance(event, yaml.AliasEvent):
            return self._anchors.get(event.anchor or "")
        if depth <= _MAX_DEPTH and isinstance(event, yaml.MappingStartEvent):
            return dict(self._mapping(depth))
        if depth <= _MAX_DEPTH and isinstance(event, yaml.SequenceStartEvent):
            return list(self._sequence(depth))
        self._pass_over(event)
        return None

    def _mapping(self, depth: int) -> Iterator[tuple[str, Any]]:
        for key in self._events:
            if isinstance(key, yaml.MappingEndEvent):
                return
            name = str(key.value).lstrip(":") if isinstance(key, yaml.ScalarEvent) else ""
            self._pass_over(key)
            value = next(self._events)
            if not name or (depth == 1 and name not in _WANTED):
                self._pass_over(value)
            else:
                yield name[:_MAX_TEXT], self._value(value, depth + 1)

    def _sequence(self, depth: int) -> Iterator[Any]:
        for event in self._events:
            if isinstance(event, yaml.SequenceEndEvent):
                return
            yield self._value(event, depth + 1)

    def _pass_over(self, event: Any) -> None:
        """Go on behind a value, whatever is in it; what an alias may mean later is kept."""
        depth = 0
        while True:
            if isinstance(event, yaml.CollectionStartEvent):
                depth += 1
            elif isinstance(event, yaml.CollectionEndEvent):
                depth -= 1
            elif isinstance(event, yaml.ScalarEvent):
                self._value(event, 0)
            if depth == 0:
                return
            event = next(self._events)
