"""Read Moodle's "Download all submissions", in folders or not.

Each student's files have the prefix `NAME_NUMBER_assignsubmission_file`, where the number is the
participant's in this assignment, a group's in one for groups, and is missing for those in no group
(`mod/assign/classes/downloader.php`; underscores in names become spaces there). Older releases end
it with an underscore. The zip does not contain the times of submission: its dates are
those of the download.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Final

from grader.submission import is_junk
from grader.text import NOTHING, Message, msg
from grader_class.find.attempt import Attempt, Export, Item, Piece, add_note, at_least_half, person

LAYOUT: Final = msg("what Moodle's “Download all submissions” makes")
_PREFIX: Final = re.compile(
    r"(?P<name>.*?)(?:_(?P<number>\d+))?_assignsubmission_(?P<kind>[a-z0-9]+)(?:_(?P<filename>.*))?",
    re.DOTALL,
)
_ONLY_TEXT: Final = msg("Only a text was handed in online, and no file.")


def matches(items: Sequence[Item]) -> bool:
    """Whether a folder has this layout."""
    return at_least_half(items, lambda item: _PREFIX.fullmatch(item.name))


def read(items: Sequence[Item]) -> Export:
    """Read the attempts in a folder."""
    pieces: dict[tuple[str, str], list[Piece]] = {}
    others = []
    for item in items:
        match = _PREFIX.fullmatch(item.name)
        if match is None:
            others.append(item.name)
            continue
        filename = match["filename"] or ""
        submitted = pieces.setdefault((match["name"], match["number"] or ""), [])
        if match["kind"] == "file" and not is_junk(filename or "a"):
            submitted.append(Piece(item.path, "" if item.is_folder else filename))
    of_groups = any(not number for _, number in pieces)  # only then are numbers missing
    attempts = [
        _attempt(name, number, found, "" if of_groups else f"Participant {number}")
        for (name, number), found in pieces.items()
    ]
    notes = list[Message]()
    add_note(notes, msg("Left out, since Moodle does not name them so: {names}."), others)
    return Export(LAYOUT, attempts, notes)


def _attempt(name: str, number: str, pieces: list[Piece], identifier: str) -> Attempt:
    """Make the attempt of a student or a group; grading worksheets have the identifier."""
    known = "" if name == "Participant" else name
    return Attempt(
        f"{name}_{number}",
        (person(number or name, known, {"Identifier": identifier}),),
        tuple(pieces),
        problem=NOTHING if pieces else _ONLY_TEXT,
        alone=True,
    )
