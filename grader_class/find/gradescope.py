"""Read Gradescope's export: `submission_NUMBER/` folders, and a file with their students.

A Ruby program writes `submission_metadata.yml`: its keys begin with colons, and a time may be a
Ruby object. It is parsed into texts alone: no tag is followed, and `sid: 007` stays '007'.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from typing import Any, Final

import yaml

from grader.text import NOTHING, Message, in_one_line, msg, reason
from grader_class.entry import Person
from grader_class.find.attempt import (
    Attempt,
    Export,
    Item,
    Piece,
    add_note,
    at_least_half,
    person,
    read_time,
)

LAYOUT: Final = msg("Gradescope's export of submissions")
METADATA: Final = "submission_metadata.yml"
#: It also holds all output of autograders.
MAX_METADATA_BYTES: Final = 100_000_000
_FOLDER: Final = re.compile(r"submission_(?P<number>\d+)")
_NO_FILES: Final = msg("Gradescope's export holds no file of this submission.")


def matches(items: Sequence[Item]) -> bool:
    """Whether a folder has this layout."""
    if any(item.name == METADATA and item.path.is_file() for item in items):
        return True
    return at_least_half(items, lambda item: item.is_folder and _FOLDER.fullmatch(item.name))


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


def _attempt(name: str, item: Item | None, data: Mapping[str, Any]) -> Attempt:
    match = _FOLDER.fullmatch(name)
    number = match["number"] if match else name
    people = tuple(_people(data.get(":submitters"))) or (person(number),)
    return Attempt(
        "+".join(sorted(each.id for each in people)),
        people,
        () if item is None else (Piece(item.path, "" if item.is_folder else item.name),),
        at=_time(data.get(":created_at")),
        problem=_NO_FILES if item is None else NOTHING,
        alone=True,
    )


def _people(value: object) -> Iterator[Person]:
    for each in value if isinstance(value, list) else ():
        if isinstance(each, dict):
            name, sid, email = (_text(each.get(key)) for key in (":name", ":sid", ":email"))
            if id := sid or email or name:
                yield person(id, name, {"SID": sid, "Email": email})


def _time(value: object) -> datetime | None:
    """Parse a time, or a Ruby object with the time in UTC."""
    return read_time(_text(value.get("utc") if isinstance(value, dict) else value))


def _text(value: object) -> str:
    return value if isinstance(value, str) and value not in ("~", "null") else ""


def _metadata(item: Item | None, notes: list[Message]) -> dict[str, dict[str, Any]]:
    """Return the metadata of each submission, by the name of its folder."""
    why = msg("there is no {file}", file=METADATA)
    if item is not None and item.path.is_file():
        try:
            return _parsed(item)
        except (yaml.YAMLError, ValueError, RecursionError) as error:
            why = msg(
                "{file} cannot be read ({why})", file=METADATA, why=in_one_line(reason(error))
            )
    notes.append(msg("Names, ids and times are missing, since {why}.", why=why))
    return {}


def _parsed(item: Item) -> dict[str, dict[str, Any]]:
    """Parse the metadata."""
    if item.path.stat().st_size > MAX_METADATA_BYTES:
        raise ValueError(msg("it has more than {size:g} MB", size=MAX_METADATA_BYTES / 1e6))
    with item.path.open("rb") as file:
        found = yaml.load(file, Loader=getattr(yaml, "CBaseLoader", yaml.BaseLoader))
    if not isinstance(found, dict):
        raise ValueError(msg("it is empty"))
    submissions = {name: data for name, data in found.items() if isinstance(data, dict)}
    return {name: data for name, data in submissions.items() if isinstance(name, str)}
