"""Read Canvas's "Download Submissions": files in one folder, with the students in their names.

`NAME[_LATE]_USER_FILE_FILENAME`, where the name is the sortable one in small letters and without
what is no letter, USER is the student's id in Canvas, and FILE that of the file. Anonymous ones are
`[LATE_]anon_CODE_FILE_FILENAME`; a text entered online ends in `_USER_text.html`, a link in
`_USER_link.html` (`lib/content_zipper.rb`). A file that a student hands in again gets `-1`, `-2`
before its suffix. The export contains no times.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from grader.submission import is_junk
from grader.text import NOTHING, Message, msg
from grader_class.entry import Person
from grader_class.find.attempt import Attempt, Export, Item, Piece, add_note, at_least_half, person

LAYOUT: Final = msg("what Canvas's “Download Submissions” makes")
_NAME: Final = re.compile(
    r"(?:(?P<late>LATE)_)?(?:anon_(?P<code>[A-Za-z0-9]+)|"
    r"(?P<name>.+?)(?:_(?P<late_too>LATE))?_(?P<user>\d+))"
    r"_(?:(?P<file>\d+)_(?P<filename>.+)|(?P<typed>text|link)\.html)",
    re.DOTALL,
)
#: `node-2.tar.gz`: the same file handed in again, for the second time.
_AGAIN: Final = re.compile(r"(?P<stem>.+)-(?P<times>[1-9]\d?)(?P<ending>(?:\.[A-Za-z0-9]+)+)")
_ONLY_TEXT: Final = msg("Only a text or a link was handed in, and no file.")


def matches(items: Sequence[Item]) -> bool:
    """Whether a folder has this layout."""
    return at_least_half(items, _parsed)


def read(items: Sequence[Item]) -> Export:
    """Read the attempts in a folder."""
    files: dict[tuple[str, str], list[tuple[Item, str]]] = defaultdict(list)
    people: dict[tuple[str, str], Person] = {}
    others: list[str] = []
    for item in items:
        match = _parsed(item)
        if match is None:
            others.append(item.name)
            continue
        is_late = match["late"] or match["late_too"]
        name, user = match["name"] or "", match["user"] or ""
        whose = (user or match["code"], name)
        columns = {"ID": user} if user else {}
        if match["typed"] and user:  # where there is no file, Canvas's id is read from this
            columns["Exported as"] = item.name
        people[whose] = person(whose[0], name, columns | ({"Late": "yes"} if is_late else {}))
        submitted = files[whose]
        if match["file"] and not is_junk(match["filename"]):
            submitted.append((item, match["filename"]))
    notes: list[Message] = []
    if len({id for id, _ in files}) < len(files):  # a student may be named like that: ann_12
        notes.append(
            msg("Some ids stand there with several names; look at these hand-ins yourself.")
        )
    add_note(notes, msg("Left out, since Canvas does not name them so: {names}."), others)
    attempts = [_attempt("_".join(key), people[key], files[key]) for key in files]
    return Export(LAYOUT, attempts, notes)


def _parsed(item: Item) -> re.Match[str] | None:
    return None if item.is_folder else _NAME.fullmatch(item.name)


def _attempt(whose: str, student: Person, files: Sequence[tuple[Item, str]]) -> Attempt:
    if files:  # Canvas assigns a feedback file to the student by this
        columns = {**student.columns, "Exported as": files[0][0].name}
        student = replace(student, columns=columns)
    again = [_AGAIN.fullmatch(name) for _, name in files]
    names = [f"{m['stem']}{m['ending']}" if m else files[at][1] for at, m in enumerate(again)]
    number = 1
    if len(set(names)) == len(names):
        number += max((int(match["times"]) for match in again if match), default=0)
    else:  # part-1.py, part-2.py: the student called them so
        names = [name for _, name in files]
    pieces = tuple(Piece(item.path, name) for (item, _), name in zip(files, names, strict=True))
    problem = NOTHING if pieces else _ONLY_TEXT
    return Attempt(whose, (student,), pieces, number, problem=problem)
