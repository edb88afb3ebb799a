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
from typing import Final, NamedTuple

from grader.batch.entry import Person
from grader.batch.find.attempt import Attempt, Export, Item, Piece, add_note, mostly, person
from grader.message import NOTHING, msg
from grader.submission.folder import is_junk
from grader.submission.unpacking import is_archive

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


class _File(NamedTuple):
    """A submitted file.

    Attributes:
        id: Canvas's number of it, which grows with time.
        original: its name, with what Canvas may have added.
        filename: its name without that.
        again: how often a file of this name had been handed in before.
    """

    item: Item
    id: int
    original: str
    filename: str
    again: int


def matches(items: Sequence[Item]) -> bool:
    """Whether a folder has this layout."""
    return mostly(items, _parsed)


def read(items: Sequence[Item]) -> Export:
    """Read the attempts in a folder."""
    files: dict[tuple[str, str], list[_File]] = defaultdict(list)
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
            submitted.append(_file(item, match))
    attempts, outdated, notes = [], list[str](), []
    for whose, submitted in files.items():
        kept, older = _newest(submitted)
        outdated += [file.item.name for file in older]
        attempts.append(_attempt("_".join(whose), people[whose], kept))
    if len({id for id, _ in files}) < len(files):  # a student may be named like that: ann_12
        notes.append(
            msg("Some ids stand there with several names; look at these hand-ins yourself.")
        )
    add_note(notes, msg("Left out, since there is a newer one of this name: {names}."), outdated)
    add_note(notes, msg("Left out, since Canvas does not name them so: {names}."), others)
    return Export(LAYOUT, attempts, notes)


def _parsed(item: Item) -> re.Match[str] | None:
    return None if item.is_folder else _NAME.fullmatch(item.name)


def _file(item: Item, match: re.Match[str]) -> _File:
    again = _AGAIN.fullmatch(filename := match["filename"])
    if again is None:
        return _File(item, int(match["file"]), filename, filename, 0)
    plain = f"{again['stem']}{again['ending']}"
    return _File(item, int(match["file"]), filename, plain, int(again["times"]))


def _newest(files: list[_File]) -> tuple[list[_File], list[_File]]:
    """Split a student's files into those that are graded, and older ones.

    An export holds one attempt, but two may have been unpacked into one folder. `part-1.py` and
    `part-2.py` are one attempt, though: of files of one name only the newest is graded where one of
    them has that very name, or where they are archives, of which there can be but one.
    """
    alike: dict[str, list[_File]] = defaultdict(list)
    for file in files:
        alike[file.filename].append(file)
    kept, older = [], []
    for same in alike.values():
        same.sort(key=lambda file: file.id)
        is_one = len(same) == 1 or any(not file.again for file in same)
        if is_one or is_archive(same[0].item.path):
            kept.append(same[-1])
            older += same[:-1]
        else:
            kept += [file._replace(filename=file.original, again=0) for file in same]
    return kept, older


def _attempt(whose: str, student: Person, files: list[_File]) -> Attempt:
    pieces = tuple(Piece(file.item.path, file.filename) for file in files)
    if files:  # Canvas assigns a feedback file to the student by this
        columns = {**student.columns, "Exported as": files[0].item.name}
        student = replace(student, columns=columns)
    number = 1 + max((file.again for file in files), default=0)
    problem = NOTHING if pieces else _ONLY_TEXT
    return Attempt(whose, (student,), pieces, number, problem=problem)
