"""Read Gradescope's export: `submission_NUMBER/` folders, and a file with their students.

A Ruby program writes `submission_metadata.yml`: its keys begin with colons, and a time may be a
Ruby object. It also holds all output of autograders. So it is parsed event by event into texts
alone, and everything that is not needed is skipped.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Final

import yaml

from grader.batch.entry import Person
from grader.batch.find.attempt import (
    Attempt,
    Export,
    Item,
    Piece,
    add_note,
    mostly,
    person,
    read_time,
)
from grader.message import NOTHING, Message, msg, reason
from grader.submission.folder import shown
from grader.text import in_one_line

LAYOUT: Final = msg("Gradescope's export of submissions")
METADATA: Final = "submission_metadata.yml"
MAX_METADATA_BYTES: Final = 200_000_000
_FOLDER: Final = re.compile(r"submission_(?P<number>\d+)")
_NO_FILES: Final = msg("Gradescope's export holds no file of this submission.")
#: The keys of a submission that are read.
_WANTED: Final = ("submitters", "created_at")
_MAX_DEPTH: Final = 4  # of submissions, submitters, and the fields of one
_MAX_TEXT: Final = 1_000  # characters; what is longer is no name


def matches(items: Sequence[Item]) -> bool:
    """Whether a folder has this layout."""
    if any(item.name == METADATA and item.path.is_file() for item in items):
        return True
    return mostly(items, lambda item: item.is_folder and _FOLDER.fullmatch(item.name))


def read(items: Sequence[Item]) -> Export:
    """Read the attempts in a folder."""
    notes: list[Message] = []
    lying = {item.name: item for item in items}
    metadata = _metadata(lying.pop(METADATA, None), notes)
    attempts = [_attempt(name, lying.pop(name, None), data) for name, data in metadata.items()]
    others = []
    for name, item in lying.items():
        if item.is_folder and _FOLDER.fullmatch(name):
            attempts.append(_attempt(name, item, {}))
        else:
            others.append(name)
    add_note(notes, msg("Left out, since Gradescope does not name them so: {names}."), others)
    return Export(LAYOUT, attempts, notes)


def _attempt(name: str, item: Item | None, data: dict[str, Any]) -> Attempt:
    match = _FOLDER.fullmatch(name)
    number = match["number"] if match else name
    people = tuple(_people(data.get("submitters"))) or (person(number),)
    return Attempt(
        "+".join(sorted(each.id for each in people)),
        people,
        () if item is None else (Piece(item.path, "" if item.is_folder else item.name),),
        at=_time(data.get("created_at")),
        problem=_NO_FILES if item is None else NOTHING,
        alone=True,
    )


def _people(value: object) -> Iterator[Person]:
    for each in value if isinstance(value, list) else ():
        if isinstance(each, dict):
            name, sid, email = (_text(each.get(key)) for key in ("name", "sid", "email"))
            if id := sid or email or name:
                yield person(id, name, {"SID": sid, "Email": email})


def _time(value: object) -> Any:
    """Parse a time, or a Ruby object with the time in UTC."""
    return read_time(_text(value.get("utc") if isinstance(value, dict) else value))


def _text(value: object) -> str:
    return value if isinstance(value, str) and value not in ("~", "null") else ""


def _metadata(item: Item | None, notes: list[Message]) -> dict[str, dict[str, Any]]:
    """Return the metadata of each submission, by the name of its folder."""
    why = msg("there is no {file}", file=METADATA)
    if item is not None and item.path.is_file():
        try:
            found = _Texts(item.path).read()
            return {name: data for name, data in found.items() if isinstance(data, dict)}
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
    """Parses the wanted texts of a YAML file into dicts and lists.

    No tag is followed and no text converted: `sid: 007` stays '007'.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._anchors: dict[str, str] = {}

    def read(self) -> dict[str, Any]:
        """Parse the file.

        Raises:
            yaml.YAMLError: it is no YAML.
            ValueError: it is too large, or no mapping.
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
        self._skip(event)
        return None

    def _mapping(self, depth: int) -> Iterator[tuple[str, Any]]:
        for key in self._events:
            if isinstance(key, yaml.MappingEndEvent):
                return
            name = str(key.value).lstrip(":") if isinstance(key, yaml.ScalarEvent) else ""
            self._skip(key)
            value = next(self._events)
            if not name or (depth == 1 and name not in _WANTED):
                self._skip(value)
            else:
                yield name[:_MAX_TEXT], self._value(value, depth + 1)

    def _sequence(self, depth: int) -> Iterator[Any]:
        for event in self._events:
            if isinstance(event, yaml.SequenceEndEvent):
                return
            yield self._value(event, depth + 1)

    def _skip(self, event: Any) -> None:
        """Skip a value with all that is in it; anchors are kept for later aliases."""
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
